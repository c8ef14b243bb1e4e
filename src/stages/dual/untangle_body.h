// untangle_sheet (see stages.h), written once over an executor.
#pragma once

#include <utility>

#include "isoshell/advanced/stages.h"
#include "stages/halfedge/intersections.h"
#include "stages/sheet/sheet_walk.h"
#include "voxel/leaf.h"

namespace isoshell {
namespace untangle {

constexpr int kHalvingRounds = 6;  ///< then all of the way
constexpr int kRounds = 24;

/// Marked vertices of a leaf go towards their lattice corners.
struct TakeBack {
  VoxelSetView corners;
  View<const uint32_t> marked;
  bool all_the_way;
  View<PointQ8> position;
  ISOSHELL_HD void operator()(int64_t leaf) const {
    const Voxel l = leaf_of_key(corners.leaf_key[leaf]);
    for_each_active(corners, leaf, [&](int offset, int64_t v) {
      if (!marked[v]) return;
      const Voxel c = voxel_at(l, offset);
      const PointQ8 corner = {c.x * kOneVoxelQ8, c.y * kOneVoxelQ8, c.z * kOneVoxelQ8}, p = position[v];
      position[v] = all_the_way ? corner : PointQ8{(p.x + corner.x) >> 1, (p.y + corner.y) >> 1, (p.z + corner.z) >> 1};
    });
  }
};

/// Seeds stay where they are, as near as the sheet around their homes now is.
struct FollowSheet {
  WalkOntoSheet walk;
  View<const uint32_t> home;
  View<PointQ8> position;
  ISOSHELL_HD void operator()(int64_t i) const { position[i] = walk.closest_around(home[i], position[i]); }
};

}  // namespace untangle

template <class Exec>
int64_t untangle_sheet_body(Exec& exec, Sheet& sheet, SeedSet& seeds) {
  using namespace untangle;
  Buffer<uint32_t> marked = exec.template make<uint32_t>(sheet.vertex_count());
  Buffer<uint32_t> moved;
  for (int round = 0;; ++round) {
    const int64_t pairs = optimize::find_intersections(exec, {sheet.triangles.view(), sheet.position.view()},
                                                       sheet.extent_vox, 1, marked.view(), moved.view());
    if (pairs == 0 || round == kRounds) {
      const WalkOntoSheet walk = walk_onto(sheet);
      exec.for_each("follow the sheet", seeds.size(), FollowSheet{walk, seeds.home.view(), seeds.position.view()});
      return pairs;
    }
    exec.for_each("take back", sheet.corners.leaf_count(),
                  TakeBack{sheet.corners.view(), marked.view(), round >= kHalvingRounds, sheet.position.view()});
    std::swap(marked, moved);
    if (marked.empty()) marked = exec.template make<uint32_t>(sheet.vertex_count());
  }
}

}  // namespace isoshell
