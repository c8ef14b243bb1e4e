// What lies beside the voxels of a leaf, a bit a voxel: a plane of 64 voxels across x is a word.
#pragma once

#include "isoshell/advanced/voxel_set.h"
#include "voxel/leaf.h"

namespace isoshell::level_set_steps {

ISOSHELL_HD inline Voxel next_along(Voxel v, int axis, int by) {
  return {v.x + (axis == 0 ? by : 0), v.y + (axis == 1 ? by : 0), v.z + (axis == 2 ? by : 0)};
}

/// The six leaves beside each leaf: by axis, the one of smaller coordinates first.
struct FindLeavesBeside {
  VoxelSetView set;
  View<uint32_t> beside;
  ISOSHELL_HD void operator()(int64_t i) const {
    beside[i] = find_leaf(set, next_along(leaf_of_key(set.leaf_key[i / 6]), int(i % 6) / 2, i % 2 == 0 ? -1 : 1));
  }
};

/// A plane of a leaf, and its way to the planes beside it.
struct PlaneOfLeaf {
  View<const uint32_t> beside;  ///< see FindLeavesBeside
  int64_t leaf;
  int x;

  ISOSHELL_HD uint64_t of(View<const LeafMask> masks) const { return masks[leaf].word[x]; }

  /// Bits of the voxels that are one step ahead along the axis.
  ISOSHELL_HD uint64_t ahead(View<const LeafMask> masks, int axis) const {
    if (axis == 0) return x < 7 ? masks[leaf].word[x + 1] : of_leaf_beside(masks, 1, 0);
    const uint64_t here = of(masks), there = of_leaf_beside(masks, 2 * axis + 1, x);
    return axis == 1 ? here >> 8 | there << 56 : (here >> 1 & ~kLastOfRows) | (there & kFirstOfRows) << 7;
  }
  /// Of those one step behind.
  ISOSHELL_HD uint64_t behind(View<const LeafMask> masks, int axis) const {
    if (axis == 0) return x > 0 ? masks[leaf].word[x - 1] : of_leaf_beside(masks, 0, 7);
    const uint64_t here = of(masks), there = of_leaf_beside(masks, 2 * axis, x);
    return axis == 1 ? here << 8 | there >> 56 : (here << 1 & ~kFirstOfRows) | (there & kLastOfRows) >> 7;
  }

 private:
  static constexpr uint64_t kFirstOfRows = 0x0101010101010101ull, kLastOfRows = kFirstOfRows << 7;

  ISOSHELL_HD uint64_t of_leaf_beside(View<const LeafMask> masks, int side, int plane) const {
    const uint32_t there = beside[6 * leaf + side];
    return there == kNone ? 0 : masks[there].word[plane];
  }
};

/// Voxels of a leaf before those of a plane.
ISOSHELL_HD inline int rank_of_plane(const LeafMask& mask, int x) {
  int rank = 0;
  for (int w = 0; w < x; ++w) rank += popcount64(mask.word[w]);
  return rank;
}

/// A plane of the leaf of a set that lies at these leaf coordinates; empty where there is none.
ISOSHELL_HD inline uint64_t plane_at(const VoxelSetView& set, Voxel leaf, int x) {
  const uint32_t there = find_leaf(set, leaf);
  return there == kNone ? 0 : set.mask[there].word[x];
}

}  // namespace isoshell::level_set_steps
