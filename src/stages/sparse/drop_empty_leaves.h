// Makes a VoxelSet of leaves that may turn out empty.
#pragma once

#include "stages/sparse/index_leaves.h"

namespace isoshell {

struct HasVoxels {
  View<const LeafMask> mask;
  ISOSHELL_HD bool operator()(int64_t i) const {
    uint64_t any = 0;
    for (const uint64_t w : mask[i].word) any |= w;
    return any != 0;
  }
};

struct CopyKeptLeaf {
  View<const uint32_t> kept;
  View<const uint64_t> from_key;
  View<const LeafMask> from_mask;
  View<uint64_t> key;
  View<LeafMask> mask;
  ISOSHELL_HD void operator()(int64_t i) const {
    key[i] = from_key[kept[i]];
    mask[i] = from_mask[kept[i]];
  }
};

/// Size of the lattice in whole blocks.
struct BlockExtent {
  int32_t vox[3];
  explicit BlockExtent(const VoxelSetView& set)
      : vox{set.block_dims[0] * 128, set.block_dims[1] * 128, set.block_dims[2] * 128} {}
};

/// The voxel set of these leaves, ascending, less those without voxels.
template <class Exec>
VoxelSet voxel_set_of(Exec& exec, View<const uint64_t> key, View<const LeafMask> mask, const int32_t extent_vox[3]) {
  const Buffer<uint32_t> kept = exec.select(key.size, HasVoxels{mask});
  VoxelSet set;
  set.leaf_key = exec.template make<uint64_t>(kept.size());
  set.mask = exec.template make<LeafMask>(kept.size());
  exec.for_each("drop empty leaves", kept.size(),
                CopyKeptLeaf{kept.view(), key, mask, set.leaf_key.view(), set.mask.view()});
  index_leaves(exec, set, extent_vox);
  return set;
}

}  // namespace isoshell
