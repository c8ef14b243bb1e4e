// The voxels of a VoxelSet, one after another.
#pragma once

#include "isoshell/advanced/voxel_set.h"

namespace isoshell {

/// Leaf coordinates of a key.
ISOSHELL_HD inline Voxel leaf_of_key(uint64_t key) {
  const uint32_t root = uint32_t(key >> 27), upper = uint32_t(key >> 12) & 32767, lower = uint32_t(key) & 4095;
  return {int32_t((root >> 20) << 9 | (upper >> 10) << 4 | lower >> 8),
          int32_t(((root >> 10) & 1023) << 9 | ((upper >> 5) & 31) << 4 | ((lower >> 4) & 15)),
          int32_t((root & 1023) << 9 | (upper & 31) << 4 | (lower & 15))};
}

/// The voxel at an offset in the leaf with these leaf coordinates.
ISOSHELL_HD inline Voxel voxel_at(Voxel leaf, int offset) {
  return {leaf.x * 8 + (offset >> 6), leaf.y * 8 + ((offset >> 3) & 7), leaf.z * 8 + (offset & 7)};
}

/// Number of the lowest set bit; w must not be 0.
ISOSHELL_HD inline int lowest_bit(uint64_t w) {
#if defined(__CUDA_ARCH__)
  return __ffsll(static_cast<long long>(w)) - 1;
#else
  return __builtin_ctzll(w);
#endif
}

/// Calls visit(offset, index) for every active voxel of a leaf, in canonical order.
template <class Visit>
ISOSHELL_HD inline void for_each_active(const VoxelSetView& set, int64_t leaf, Visit visit) {
  int64_t index = set.first[leaf];
  for (int w = 0; w < 8; ++w)
    for (uint64_t bits = set.mask[leaf].word[w]; bits; bits &= bits - 1) visit(w * 64 + lowest_bit(bits), index++);
}

/// Calls visit(voxel, index) for every active voxel, in canonical order: its value is the one of that index in the
/// arrays beside the set. The set is in host memory; to_host() brings it there.
template <class Visit>
void for_each_voxel(const VoxelSet& voxels, Visit visit) {
  const VoxelSetView view = voxels.view();
  for (int64_t l = 0; l < voxels.leaf_count(); ++l) {
    const Voxel leaf = leaf_of_key(view.leaf_key[l]);
    for_each_active(view, l, [&](int offset, int64_t index) { visit(voxel_at(leaf, offset), index); });
  }
}

}  // namespace isoshell
