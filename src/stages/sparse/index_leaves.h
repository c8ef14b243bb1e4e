// The index of a VoxelSet: prefix sums of the masks and the two-level leaf lookup.
#pragma once

#include "isoshell/advanced/voxel_set.h"
#include "voxel/atomic.h"
#include "voxel/leaf.h"

namespace isoshell {
namespace leaf_index {

struct VoxelsOf {
  View<const LeafMask> mask;
  ISOSHELL_HD int64_t operator()(int64_t leaf) const { return voxels_in(mask[leaf]); }
};

/// Whether a leaf is the first of its block.
struct StartsBlock {
  View<const uint64_t> leaf_key;
  ISOSHELL_HD uint32_t operator()(int64_t l) const {
    return l == 0 || leaf_key[l] >> 12 != leaf_key[l - 1] >> 12 ? 1 : 0;
  }
};

struct EnterLeaf {
  int32_t block_dims[3];
  View<const uint64_t> leaf_key;
  View<const uint32_t> starts_before;  ///< each leaf, and all
  View<LeafBlock> blocks;
  View<uint32_t> block_table;
  ISOSHELL_HD void operator()(int64_t l) const {
    const uint64_t key = leaf_key[l];
    const uint32_t b = starts_before[l + 1] - 1;
    atomic_or(blocks[b].word[(key & 4095) >> 6], uint64_t(1) << (key & 63));
    if (starts_before[l] == starts_before[l + 1]) return;
    blocks[b].first_leaf = uint32_t(l);
    const Voxel leaf = leaf_of_key(key);
    block_table[(int64_t(leaf.x >> 4) * block_dims[1] + (leaf.y >> 4)) * block_dims[2] + (leaf.z >> 4)] = b;
  }
};

struct CountLeavesBefore {
  View<LeafBlock> blocks;
  ISOSHELL_HD void operator()(int64_t b) const {
    int before = 0;
    for (int w = 0; w < 64; ++w) {
      blocks[b].before[w] = uint16_t(before);
      before += popcount64(blocks[b].word[w]);
    }
  }
};

}  // namespace leaf_index

/// Completes a VoxelSet whose leaf_key (ascending, unique) and mask are filled. `extent_vox` is the lattice's size.
/// Leaves must have at least one active voxel.
template <class Exec>
void index_leaves(Exec& exec, VoxelSet& set, const int32_t extent_vox[3]) {
  using namespace leaf_index;
  const int64_t leaves = set.leaf_count();
  set.first = exec.template make<int64_t>(leaves + 1);
  set.active = exec.exclusive_scan_of(leaves, VoxelsOf{set.mask.view()}, set.first.view());

  for (int axis = 0; axis < 3; ++axis) set.block_dims[axis] = (extent_vox[axis] + 127) / 128;
  set.block_table = exec.template make<uint32_t>(int64_t(set.block_dims[0]) * set.block_dims[1] * set.block_dims[2]);
  exec.fill(set.block_table.view(), kNone);
  Buffer<uint32_t> starts = exec.template make<uint32_t>(leaves + 1);
  set.blocks =
      exec.template make<LeafBlock>(exec.exclusive_scan_of(leaves, StartsBlock{set.leaf_key.view()}, starts.view()));
  exec.fill(set.blocks.view(), LeafBlock{});
  exec.for_each("enter leaves", leaves,
                EnterLeaf{{set.block_dims[0], set.block_dims[1], set.block_dims[2]},
                          set.leaf_key.view(),
                          starts.view(),
                          set.blocks.view(),
                          set.block_table.view()});
  exec.for_each("count leaves before", set.blocks.size(), CountLeavesBefore{set.blocks.view()});
}

}  // namespace isoshell
