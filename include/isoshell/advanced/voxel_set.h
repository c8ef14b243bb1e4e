// A sparse set of lattice points (voxels, or lattice corners named like the voxel they are the smallest corner of):
// 8x8x8 leaves with bit masks, in the order NanoVDB keeps them. Topology only; values live in flat arrays beside it.
#pragma once

#include <cstdint>

#include "isoshell/advanced/buffer.h"
#include "isoshell/advanced/lattice.h"

namespace isoshell {

constexpr uint32_t kNone = 0xffffffffu;  ///< "no such element" in every 32-bit index

/// Active bits of one leaf. Offset of a voxel in its leaf = x*64 + y*8 + z; bit (offset & 63) of word[offset >> 6].
struct LeafMask {
  uint64_t word[8];
};

/// Which leaves exist in one block of 16x16x16 leaves (128^3 voxels).
struct LeafBlock {
  uint64_t word[64];    ///< bit per leaf, in key order
  uint32_t first_leaf;  ///< number of the block's first leaf
  uint16_t before[64];  ///< leaves of this block in words before this one
  uint32_t zero;        ///< fills the last word
};

/// What a kernel sees of a VoxelSet. Lookups cost one table read, one bit test and one popcount.
struct VoxelSetView {
  int32_t block_dims[3];             ///< blocks per axis of the dense table
  View<const uint32_t> block_table;  ///< x-major; number of the block or kNone
  View<const LeafBlock> blocks;
  View<const uint64_t> leaf_key;  ///< canonical order, see voxel/leaf.h
  View<const LeafMask> mask;
  View<const int64_t> first;  ///< leaf_count + 1 entries: index of each leaf's first active voxel, then the total
};

/// Owner of the arrays of a VoxelSetView. Immutable once made.
/// Canonical order of its voxels, which is file order, index order and digest order: leaf key, then offset in the leaf.
struct VoxelSet {
  int32_t block_dims[3] = {};
  Buffer<uint32_t> block_table;
  Buffer<LeafBlock> blocks;
  Buffer<uint64_t> leaf_key;
  Buffer<LeafMask> mask;
  Buffer<int64_t> first;
  int64_t active = 0;  ///< number of active voxels

  int64_t leaf_count() const { return leaf_key.size(); }
  int64_t voxel_count() const { return active; }
  int64_t size_bytes() const {
    return block_table.size_bytes() + blocks.size_bytes() + leaf_key.size_bytes() + mask.size_bytes() +
           first.size_bytes();
  }
  VoxelSetView view() const {
    return {{block_dims[0], block_dims[1], block_dims[2]},
            block_table.view(),
            blocks.view(),
            leaf_key.view(),
            mask.view(),
            first.view()};
  }
};

}  // namespace isoshell
