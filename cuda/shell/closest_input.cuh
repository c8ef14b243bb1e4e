// What the distance transform over rows of leaves reads and writes.
#pragma once

#include "isoshell/advanced/voxel_set.h"
#include "voxel/leaf.h"

namespace isoshell {
namespace closest {

struct Rows {
  View<const uint32_t> first_leaf;  ///< of each row: number of its first leaf; a prefix of the array is in use
  const uint32_t* count;
  uint32_t* next;  ///< row to take next; 0 at the start
  int32_t leaves;  ///< of a row at most: 1, 2, 4 or 8; rows start at multiples of it
};

/// A word of the sites' masks, and the site id of its first voxel.
struct alignas(16) SiteWord {
  uint64_t bits;
  uint32_t first;
};

struct Input {
  VoxelSetView sites, shell;
  const SiteWord* words;  ///< of the sites' leaves, eight each
  int32_t band_vox;
};

/// The leaves' masks and numbers of voxels, or with the masks in hand the values.
struct Output {
  LeafMask* mask;
  int64_t* count;
  uint32_t* closest_site;
  uint16_t* distance_sq_vox;
};

__device__ inline uint32_t site_number(const SiteWord& word, int bit) {
  return word.first + uint32_t(__popcll(word.bits & ((uint64_t(1) << bit) - 1)));
}

/// A block's 16 leaves along z, and its leaves before them.
struct LeafRow {
  uint32_t bits, before;
};
__device__ inline LeafRow leaf_row(const VoxelSetView& set, Voxel leaf) {
  const int32_t bx = leaf.x >> 4, by = leaf.y >> 4, bz = leaf.z >> 4;
  if (bx < 0 || by < 0 || bz < 0 || bx >= set.block_dims[0] || by >= set.block_dims[1] || bz >= set.block_dims[2])
    return {0, 0};
  const uint32_t b = set.block_table.data[(int64_t(bx) * set.block_dims[1] + by) * set.block_dims[2] + bz];
  if (b == kNone) return {0, 0};
  const LeafBlock& block = set.blocks.data[b];
  const int at = (leaf.x & 15) << 2 | (leaf.y & 15) >> 2, shift = (leaf.y & 3) << 4;
  const uint64_t word = block.word[at];
  return {uint32_t(word >> shift) & 0xffff,
          block.first_leaf + block.before[at] + uint32_t(popcount64(word & ((uint64_t(1) << shift) - 1)))};
}

/// Numbers of `count` leaves along z from `first` on, kNone where there is none; returns whether there are any.
__device__ inline bool find_leaves_along_z(const VoxelSetView& set, Voxel first, int count, uint32_t* out) {
  LeafRow row = {};
  bool some = false;
#pragma unroll 1
  for (int i = 0; i < count; ++i, ++first.z) {
    const uint32_t z = uint32_t(first.z) & 15;
    if (i == 0 || z == 0) row = leaf_row(set, first);
    const bool is_here = row.bits >> z & 1;
    out[i] = is_here ? row.before + uint32_t(__popc(row.bits & ((1u << z) - 1))) : kNone;
    some |= is_here;
  }
  return some;
}

}  // namespace closest
}  // namespace isoshell
