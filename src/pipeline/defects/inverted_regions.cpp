// find_inverted_regions (see inverted_regions.h).
#include "pipeline/defects/inverted_regions.h"

#include <algorithm>
#include <map>

#include "geometry/world_vector.h"

namespace isoshell {

std::vector<uint32_t> find_inverted_regions(const CutSurface& cut, const DualMesh& mesh,
                                            const std::vector<uint32_t>& patch) {
  const std::vector<std::array<int32_t, 2>> labels = labels_of_patches(cut);
  const auto at = [&](uint32_t v) {
    const PointQ8 p = mesh.position[v];
    return WorldPoint{double(p.x), double(p.y), double(p.z)};
  };
  struct Region {
    WorldPoint from;  ///< of its own points, so that volumes of small regions are not lost in rounding
    double volume = 0;
  };
  std::map<int32_t, Region> regions;
  for (size_t i = 0; i < patch.size(); ++i) {
    const TriangleIndices t = mesh.triangles[int64_t(i)];
    double side = 1;
    for (const int32_t label : labels[patch[i]]) {
      Region& region = regions.emplace(label, Region{at(t.a), 0}).first->second;
      const WorldPoint a = at(t.a) - region.from, b = at(t.b) - region.from, c = at(t.c) - region.from;
      region.volume += side * dot(a, cross(b, c));
      side = -1;
    }
  }
  regions.erase(cut.regions->background);
  std::vector<uint32_t> found;
  for (size_t i = 0; i < patch.size(); ++i)
    for (const int32_t label : labels[patch[i]]) {
      const auto region = regions.find(label);
      const TriangleIndices t = mesh.triangles[int64_t(i)];
      if (region != regions.end() && region->second.volume <= 0) found.insert(found.end(), {t.a, t.b, t.c});
    }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

}  // namespace isoshell
