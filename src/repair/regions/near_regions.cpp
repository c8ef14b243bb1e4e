// See near_regions.h.
#include "repair/regions/near_regions.h"

#include <algorithm>
#include <map>
#include <set>

#include "core/parallel_ranges.h"
#include "core/watched.h"
#include "geometry/triangle_grid.h"

namespace isoshell {
namespace repair {
namespace {

using Pair = std::array<int32_t, 2>;

Pair pair_of(int32_t a, int32_t b) { return {std::min(a, b), std::max(a, b)}; }

/// The outer faces of regions, towards the background, and the label behind each.
struct OuterFaces {
  std::vector<std::array<uint32_t, 3>> triangles;
  std::vector<int32_t> label;
};

OuterFaces outer_faces(const TriangleSoup& walls) {
  OuterFaces out;
  for (size_t t = 0; t < walls.triangles.size(); ++t) {
    const auto& [behind, front] = walls.regions.labels[t];
    if (behind == front || front != walls.regions.background) continue;
    out.triangles.push_back(walls.triangles[t]);
    out.label.push_back(behind);
  }
  return out;
}

/// Those that have a vertex in common.
std::set<Pair> touching_pairs(const TriangleSoup& walls) {
  std::vector<std::array<uint32_t, 2>> at;  // vertex, label
  for (size_t t = 0; t < walls.triangles.size(); ++t)
    for (const uint32_t v : walls.triangles[t])
      for (const int32_t label : walls.regions.labels[t]) at.push_back({v, uint32_t(label)});
  std::sort(at.begin(), at.end());
  at.erase(std::unique(at.begin(), at.end()), at.end());
  std::set<Pair> pairs;
  for (size_t i = 0; i < at.size(); ++i)
    for (size_t j = i; j-- > 0 && at[j][0] == at[i][0];) pairs.insert(pair_of(int32_t(at[j][1]), int32_t(at[i][1])));
  return pairs;
}

}  // namespace

std::vector<NearRegions> find_near_regions(const TriangleSoup& walls, double within_world, const Context& context) {
  const OuterFaces outer = outer_faces(walls);
  if (outer.triangles.empty() || within_world <= 0) return {};
  const std::set<Pair> touching = touching_pairs(walls);
  const TriangleGrid grid(walls.vertices, outer.triangles);
  struct Near {
    double distance_sq;
    WorldPoint at;
    int32_t other;
  };
  std::vector<Near> nearest(outer.triangles.size(), {0, {0, 0, 0}, walls.regions.background});
  for_each_index(size_t(0), nearest.size(), [&](size_t t) {
    check_cancel(context, "regions");
    const int32_t label = outer.label[t];
    const auto& [a, b, c] = outer.triangles[t];
    const WorldPoint corner[3] = {walls.vertices[a], walls.vertices[b], walls.vertices[c]};
    Near& best = nearest[t];
    best.distance_sq = within_world * within_world;
    for (const WorldPoint& p : {corner[0], corner[1], corner[2], 1. / 3 * (corner[0] + corner[1] + corner[2])}) {
      const MeshPoint found = grid.view().search(p, best.distance_sq, [&](uint32_t other) {
        return outer.label[other] != label && touching.count(pair_of(outer.label[other], label)) == 0;
      });
      if (found.triangle != MeshPoint::kNoTriangle && found.distance_sq < best.distance_sq)
        best = {found.distance_sq, p, outer.label[found.triangle]};
    }
  });
  std::map<Pair, NearRegions> pairs;
  for (size_t t = 0; t < nearest.size(); ++t) {
    const Near& near = nearest[t];
    if (near.other == walls.regions.background) continue;
    const Pair labels = pair_of(outer.label[t], near.other);
    const NearRegions found{labels, std::sqrt(near.distance_sq), near.at};
    const auto [at, is_new] = pairs.emplace(labels, found);
    if (!is_new && found.distance_world < at->second.distance_world) at->second = found;
  }
  std::vector<NearRegions> out;
  for (const auto& [labels, near] : pairs) out.push_back(near);
  std::stable_sort(out.begin(), out.end(),
                   [](const NearRegions& a, const NearRegions& b) { return a.distance_world < b.distance_world; });
  return out;
}

}  // namespace repair
}  // namespace isoshell
