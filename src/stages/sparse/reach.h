// Dilation of voxel sets: every voxel within a radius of one of a set.
#pragma once

#include "isoshell/advanced/site_set.h"
#include "stages/sparse/drop_empty_leaves.h"
#include "stages/sparse/marked_leaves.h"
#include "voxel/closest.h"

namespace isoshell {
namespace reach_steps {

/// Leaves that may hold voxels within the radius of a leaf's sites: calls run(x, y, first z, last z), leaf coordinates.
template <class Run>
ISOSHELL_HD inline void for_each_reached_run(const VoxelSetView& sites, int64_t leaf, const Ball& ball, Run run) {
  const LeafMask& mask = sites.mask[leaf];
  uint64_t all = 0;
  int x0 = 8, x1 = 0;
  for (int x = 0; x < 8; ++x) {
    all |= mask.word[x];
    if (!mask.word[x]) continue;
    x0 = x0 < x ? x0 : x;
    x1 = x;
  }
  if (!all) return;
  int y0 = 8, y1 = 0, z0 = 8, z1 = 0;
  for (int i = 0; i < 8; ++i) {
    if (all >> (8 * i) & 255) y0 = y0 < i ? y0 : i, y1 = i;
    if (all >> i & 0x0101010101010101ull) z0 = z0 < i ? z0 : i, z1 = i;
  }
  const Voxel at = leaf_of_key(sites.leaf_key[leaf]);
  const int reach = reach_leaves(ball.radius);
  // Gap between the box of the sites and the leaf `l` leaves away, along one axis.
  const auto gap = [](int lo, int hi, int l) { return 8 * l > hi ? 8 * l - hi : lo > 8 * l + 7 ? lo - 8 * l - 7 : 0; };
  for (int x = -reach; x <= reach; ++x)
    for (int y = -reach; y <= reach; ++y) {
      const int gx = gap(x0, x1, x), gy = gap(y0, y1, y);
      if (gx > ball.radius || gy > ball.radius || ball.half[gx][gy] < 0) continue;
      const Voxel l = {at.x + x, at.y + y, 0};
      if (l.x < 0 || l.y < 0 || l.x >= sites.block_dims[0] * 16 || l.y >= sites.block_dims[1] * 16) continue;
      const int first = at.z + ((z0 - ball.half[gx][gy]) >> 3), last = at.z + ((z1 + ball.half[gx][gy]) >> 3);
      const int end = sites.block_dims[2] * 16 - 1;
      run(l.x, l.y, first > 0 ? first : 0, last < end ? last : end);
    }
}

/// For marked_leaves.h.
struct ReachedLeaves {
  VoxelSetView sites;
  Ball ball;
  template <class Run>
  ISOSHELL_HD void operator()(int64_t leaf, Run run) const {
    for_each_reached_run(sites, leaf, ball, run);
  }
};

/// The voxels of a leaf that the ball around some site reaches.
template <class LeafPasses>
struct ReachLeaf {
  VoxelSetView sites;
  Ball ball;
  View<const uint64_t> leaf_key;
  View<LeafMask> mask;
  void operator()(int64_t i) const {
    Neighbourhood around;
    find_neighbours(around, sites, leaf_of_key(leaf_key[i]), reach_leaves(ball.radius));
    LeafPasses::reached(around, sites.mask.data, ball, mask[i]);
  }
};

/// Every voxel within the ball's radius of one of the set.
template <class LeafPasses, class Exec>
VoxelSet reach(Exec& exec, const VoxelSetView& sites, const Ball& ball) {
  const Buffer<uint64_t> key =
      mark_leaves(exec, sites.block_dims, sites.leaf_key.size, ReachedLeaves{sites, ball}).leaf_key;
  Buffer<LeafMask> mask = exec.template make<LeafMask>(key.size());
  exec.for_each("reach", key.size(), ReachLeaf<LeafPasses>{sites, ball, key.view(), mask.view()});
  return voxel_set_of(exec, key.view(), mask.view(), BlockExtent(sites).vox);
}

}  // namespace reach_steps

/// The voxels within a radius of those of a set, for a body that needs no closest sites.
struct PlainDilate {
  template <class Exec>
  static VoxelSet run(Exec& exec, const SiteSet& sites, int32_t radius_vox) {
    return reach_steps::reach<typename Exec::Kernels::LeafPasses>(exec, sites.voxels.view(),
                                                                  ball_of_radius(radius_vox));
  }
};

}  // namespace isoshell
