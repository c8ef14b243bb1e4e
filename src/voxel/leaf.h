// Arithmetic of 8x8x8 leaves: keys in NanoVDB's node order, offsets, and lookups in a VoxelSetView.
#pragma once

#include <cstdint>

#include "isoshell/advanced/each_voxel.h"

namespace isoshell {

/// Key of the leaf with leaf coordinates (voxel >> 3), each below 2^19: root tile, then upper node offset (32^3 lower
/// nodes), then lower node offset (16^3 leaves), each x-major. Sorting keys gives NanoVDB's breadth-first leaf order.
ISOSHELL_HD inline uint64_t leaf_key(Voxel leaf) {
  const uint64_t x = uint64_t(leaf.x), y = uint64_t(leaf.y), z = uint64_t(leaf.z);
  const uint64_t root = (x >> 9) << 20 | (y >> 9) << 10 | (z >> 9);
  const uint64_t upper = ((x >> 4) & 31) << 10 | ((y >> 4) & 31) << 5 | ((z >> 4) & 31);
  const uint64_t lower = (x & 15) << 8 | (y & 15) << 4 | (z & 15);
  return root << 27 | upper << 12 | lower;
}

ISOSHELL_HD inline Voxel leaf_of_voxel(Voxel v) { return {v.x >> 3, v.y >> 3, v.z >> 3}; }
ISOSHELL_HD inline int offset_in_leaf(Voxel v) { return (v.x & 7) << 6 | (v.y & 7) << 3 | (v.z & 7); }

ISOSHELL_HD inline PointQ8 voxel_centre(Voxel v) {
  const int32_t half = kOneVoxelQ8 / 2;
  return {v.x * kOneVoxelQ8 + half, v.y * kOneVoxelQ8 + half, v.z * kOneVoxelQ8 + half};
}
ISOSHELL_HD inline Voxel voxel_of(PointQ8 p) {
  return {p.x >> kFractionBits, p.y >> kFractionBits, p.z >> kFractionBits};
}

/// Place of the neighbour at (dx, dy, dz), each -1 to 1, among the 27: x-major.
ISOSHELL_HD inline int neighbour_number(int dx, int dy, int dz) { return (dx + 1) * 9 + (dy + 1) * 3 + dz + 1; }

ISOSHELL_HD inline int popcount64(uint64_t w) {
#if defined(__CUDA_ARCH__)
  return __popcll(w);
#elif defined(__POPCNT__) || !defined(__x86_64__)
  return __builtin_popcountll(w);
#else  // without the instruction the builtin is a call; compilers turn this into the instruction where they may
  w -= w >> 1 & 0x5555555555555555ull;
  w = (w & 0x3333333333333333ull) + (w >> 2 & 0x3333333333333333ull);
  w = (w + (w >> 4)) & 0x0f0f0f0f0f0f0f0full;
  return int(w * 0x0101010101010101ull >> 56);
#endif
}

ISOSHELL_HD inline int voxels_in(const LeafMask& mask) {
  int voxels = 0;
  for (const uint64_t word : mask.word) voxels += popcount64(word);
  return voxels;
}

/// Active voxels of the leaf before this offset.
ISOSHELL_HD inline int rank_in_leaf(const LeafMask& mask, int offset) {
  int rank = 0;
  for (int w = 0; w < offset >> 6; ++w) rank += popcount64(mask.word[w]);
  return rank + popcount64(mask.word[offset >> 6] & ((uint64_t(1) << (offset & 63)) - 1));
}
ISOSHELL_HD inline bool is_on(const LeafMask& mask, int offset) { return mask.word[offset >> 6] >> (offset & 63) & 1; }

/// Number of the leaf at these leaf coordinates, or kNone. Any coordinates are allowed.
ISOSHELL_HD inline uint32_t find_leaf(const VoxelSetView& set, Voxel leaf) {
  const int32_t bx = leaf.x >> 4, by = leaf.y >> 4, bz = leaf.z >> 4;
  if (bx < 0 || by < 0 || bz < 0 || bx >= set.block_dims[0] || by >= set.block_dims[1] || bz >= set.block_dims[2])
    return kNone;
  const uint32_t b = set.block_table[(int64_t(bx) * set.block_dims[1] + by) * set.block_dims[2] + bz];
  if (b == kNone) return kNone;
  const LeafBlock& block = set.blocks[b];
  const int bit = (leaf.x & 15) << 8 | (leaf.y & 15) << 4 | (leaf.z & 15);
  const uint64_t word = block.word[bit >> 6];
  if (!(word >> (bit & 63) & 1)) return kNone;
  return block.first_leaf + block.before[bit >> 6] + uint32_t(popcount64(word & ((uint64_t(1) << (bit & 63)) - 1)));
}

/// Index of an active voxel in canonical order, or -1.
ISOSHELL_HD inline int64_t find_voxel(const VoxelSetView& set, Voxel v) {
  const uint32_t leaf = find_leaf(set, leaf_of_voxel(v));
  if (leaf == kNone) return -1;
  const int offset = offset_in_leaf(v);
  const LeafMask& mask = set.mask[leaf];
  return is_on(mask, offset) ? set.first[leaf] + rank_in_leaf(mask, offset) : -1;
}

/// The active voxel with this index. Cost: a search in `first`.
ISOSHELL_HD inline Voxel voxel_of_index(const VoxelSetView& set, int64_t index) {
  int64_t lo = 0, hi = set.leaf_key.size;
  while (hi - lo > 1) {
    const int64_t mid = lo + (hi - lo) / 2;
    if (set.first[mid] <= index)
      lo = mid;
    else
      hi = mid;
  }
  int rank = int(index - set.first[lo]), w = 0;
  for (; rank >= popcount64(set.mask[lo].word[w]); ++w) rank -= popcount64(set.mask[lo].word[w]);
  uint64_t bits = set.mask[lo].word[w];
  for (; rank > 0; --rank) bits &= bits - 1;
  return voxel_at(leaf_of_key(set.leaf_key[lo]), w * 64 + lowest_bit(bits));
}

}  // namespace isoshell
