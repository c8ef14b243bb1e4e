// find_inverted_regions (see inverted_regions.h).
#include "pipeline/defects/inverted_regions.h"

#include <algorithm>
#include <iterator>
#include <map>

#include "features/mesh/refine_mesh.h"
#include "geometry/world_vector.h"

namespace isoshell {
namespace {

using Labels = std::array<int32_t, 2>;

/// Six times the volume of each region but the background, each from one of its own points, so that those of small ones
/// are not lost in rounding. Sheets bound none. Calls for_each(visit), and that visit(labels, a, b, c) for triangles.
template <class ForEach>
std::map<int32_t, double> volumes_of(int32_t background, ForEach for_each) {
  struct Region {
    WorldPoint from;
    double volume = 0;
  };
  std::map<int32_t, Region> regions;
  for_each([&](const Labels& labels, const WorldPoint& a, const WorldPoint& b, const WorldPoint& c) {
    double side = 1;
    for (const int32_t label : labels) {
      if (label == background || is_of_sheet(labels)) continue;
      Region& region = regions.emplace(label, Region{a, 0}).first->second;
      region.volume += side * dot(a - region.from, cross(b - region.from, c - region.from));
      side = -1;
    }
  });
  std::map<int32_t, double> volumes;
  for (const auto& [label, region] : regions) volumes[label] = region.volume;
  return volumes;
}

}  // namespace

std::vector<uint32_t> find_inverted_regions(const CutSurface& cut, const DualMesh& mesh,
                                            const std::vector<uint32_t>& patch) {
  const std::vector<Labels> labels = labels_of_patches(cut);
  const auto at = [&](uint32_t v) {
    const PointQ8 p = mesh.position[v];
    return WorldPoint{double(p.x), double(p.y), double(p.z)};
  };
  std::map<int32_t, double> inverted = volumes_of(cut.regions->background, [&](auto visit) {
    for (size_t i = 0; i < patch.size(); ++i) {
      const TriangleIndices t = mesh.triangles[int64_t(i)];
      visit(labels[patch[i]], at(t.a), at(t.b), at(t.c));
    }
  });
  for (auto i = inverted.begin(); i != inverted.end();) i = i->second > 0 ? inverted.erase(i) : std::next(i);
  if (inverted.empty()) return {};
  const FineMesh& fine = *cut.fine;
  const std::map<int32_t, double> before = volumes_of(cut.regions->background, [&](auto visit) {
    for (size_t t = 0; t < fine.triangles.size(); ++t) {
      const auto& [a, b, c] = fine.triangles[t];
      visit(cut.regions->labels[fine.source_face[t]], fine.position[a], fine.position[b], fine.position[c]);
    }
  });
  std::vector<uint32_t> found;
  for (size_t i = 0; i < patch.size(); ++i)
    for (const int32_t label : labels[patch[i]]) {
      if (inverted.count(label) == 0 || before.at(label) <= 0) continue;
      const TriangleIndices t = mesh.triangles[int64_t(i)];
      found.insert(found.end(), {t.a, t.b, t.c});
    }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

}  // namespace isoshell
