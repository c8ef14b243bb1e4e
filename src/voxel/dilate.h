// A leaf's mask grown by its 26 neighbours, by bit operations on slices of 8x8 voxels.
#pragma once

#include "voxel/leaf.h"

namespace isoshell {

/// Slice grown by one voxel along z; `below` and `above` are the same slice of the leaves at dz = -1 and 1.
ISOSHELL_HD inline uint64_t dilate_z(uint64_t slice, uint64_t below, uint64_t above) {
  constexpr uint64_t kFirst = 0x0101010101010101ull, kLast = kFirst << 7;
  return slice | (slice << 1 & ~kFirst) | (slice >> 1 & ~kLast) | (below >> 7 & kFirst) | (above << 7 & kLast);
}

/// Slice grown by one voxel along y, given the z-grown slices of the leaves at dy = -1, 0 and 1.
ISOSHELL_HD inline uint64_t dilate_y(uint64_t slice, uint64_t below, uint64_t above) {
  return slice | slice << 8 | slice >> 8 | below >> 56 | above << 56;
}

/// Slice x, -1..8, of the middle column of leaves, grown along z and y. around[n]: the set's mask in neighbour n, null
/// where it is empty.
ISOSHELL_HD inline uint64_t grown_slice(const LeafMask* const around[27], int x) {
  const int dx = x < 0 ? -1 : x > 7 ? 1 : 0, slice = x & 7;
  uint64_t row[3];
  for (int dy = -1; dy <= 1; ++dy) {
    const auto word = [&](int dz) {
      const LeafMask* mask = around[neighbour_number(dx, dy, dz)];
      return mask ? mask->word[slice] : 0;
    };
    row[dy + 1] = dilate_z(word(0), word(-1), word(1));
  }
  return dilate_y(row[1], row[0], row[2]);
}

/// Voxels of the middle leaf that are in the set or have a 26-neighbour in it.
ISOSHELL_HD inline LeafMask dilate_26(const LeafMask* const around[27]) {
  LeafMask out{};
  for (int x = -1; x <= 8; ++x) {
    const uint64_t grown = grown_slice(around, x);
    for (int to = x - 1; to <= x + 1; ++to)
      if (to >= 0 && to < 8) out.word[to] |= grown;
  }
  return out;
}

/// True when a voxel of the mask touches the neighbour at (dx, dy, dz): its bits on that face, edge or corner.
ISOSHELL_HD inline bool reaches(const LeafMask& mask, int dx, int dy, int dz) {
  uint64_t any = 0;
  for (int x = dx > 0 ? 7 : 0; x <= (dx < 0 ? 0 : 7); ++x) any |= mask.word[x];
  if (dy != 0) any &= dy < 0 ? 255ull : 255ull << 56;
  if (dz != 0) any &= dz < 0 ? 0x0101010101010101ull : 0x8080808080808080ull;
  return any != 0;
}

}  // namespace isoshell
