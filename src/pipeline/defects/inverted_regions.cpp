// find_inverted_regions (see inverted_regions.h).
#include "pipeline/defects/inverted_regions.h"

#include <algorithm>
#include <map>

#include "geometry/world_vector.h"

namespace isoshell {

std::vector<uint32_t> find_inverted_regions(const CutSurface& cut, const SeededMesh& made) {
  const std::vector<std::array<int32_t, 2>> labels = labels_of_patches(cut);
  const auto labels_at = [&](const TriangleIndices& t) { return labels[cut.surface.patch[made.seeds.home[t.a]]]; };
  const auto at = [&](uint32_t v) {
    const PointQ8 p = made.mesh.position[v];
    return WorldPoint{double(p.x), double(p.y), double(p.z)};
  };
  struct Region {
    WorldPoint from;  ///< of its own points, so that volumes of small regions are not lost in rounding
    double volume = 0;
  };
  std::map<int32_t, Region> regions;
  for (const TriangleIndices& t : made.mesh.triangles) {
    double side = 1;
    for (const int32_t label : labels_at(t)) {
      Region& region = regions.emplace(label, Region{at(t.a), 0}).first->second;
      const WorldPoint &o = region.from, a = at(t.a) - o, b = at(t.b) - o, c = at(t.c) - o;
      region.volume += side * dot(a, cross(b, c));
      side = -1;
    }
  }
  regions.erase(cut.regions->background);
  std::vector<uint32_t> found;
  for (const TriangleIndices& t : made.mesh.triangles)
    for (const int32_t label : labels_at(t)) {
      const auto region = regions.find(label);
      if (region != regions.end() && region->second.volume <= 0) found.insert(found.end(), {t.a, t.b, t.c});
    }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

}  // namespace isoshell
