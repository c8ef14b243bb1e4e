// Bit tricks on the masks of a leaf (8 words, one per x; bit y*8+z) and of a block of 16^3 leaves (64 words).
#pragma once

#include <cstdint>

#include "isoshell/advanced/voxel_set.h"

namespace isoshell {

constexpr uint64_t kLowZ = 0x0101010101010101ull;   ///< voxels of a word with z = 0
constexpr uint64_t kHighZ = 0x8080808080808080ull;  ///< and with z = 7

// A face of a cube is 2 * axis, plus 1 on the positive side: -x, +x, -y, +y, -z, +z.

/// The lattice point one step through face f.
ISOSHELL_HD inline Voxel step_through(Voxel v, int face, int32_t by = 1) {
  const int32_t d = face & 1 ? by : -by;
  return {v.x + (face < 2 ? d : 0), v.y + (face >> 1 == 1 ? d : 0), v.z + (face >> 1 == 2 ? d : 0)};
}

/// Voxels of the neighbour leaf beyond `face` that touch voxels of `from`.
ISOSHELL_HD inline LeafMask crossing(const LeafMask& from, int face) {
  LeafMask to = {};
  if (face == 0) to.word[7] = from.word[0];
  if (face == 1) to.word[0] = from.word[7];
  for (int x = 0; x < 8; ++x) {
    if (face == 2) to.word[x] = from.word[x] << 56;
    if (face == 3) to.word[x] = from.word[x] >> 56;
    if (face == 4) to.word[x] = (from.word[x] & kLowZ) << 7;
    if (face == 5) to.word[x] = (from.word[x] & kHighZ) >> 7;
  }
  return to;
}

ISOSHELL_HD inline LeafMask uniform_leaf(bool on) {
  const uint64_t w = on ? ~uint64_t(0) : 0;
  return {{w, w, w, w, w, w, w, w}};
}

/// Spreads `reached` within one x-layer of a leaf through the voxels of `free`.
ISOSHELL_HD inline uint64_t flood_word(uint64_t free, uint64_t reached) {
  for (;;) {
    const uint64_t grown =
        free & (reached | (reached << 1 & ~kLowZ) | (reached >> 1 & ~kHighZ) | reached << 8 | reached >> 8);
    if (grown == reached) return reached;
    reached = grown;
  }
}

/// Spreads `reached`, a subset of `free`, to every voxel of `free` that a path of face neighbours in the leaf leads to.
ISOSHELL_HD inline void flood_leaf(const LeafMask& free, LeafMask& reached) {
  for (bool grew = true; grew;) {
    grew = false;
    for (int pass = 0; pass < 2; ++pass)
      for (int i = 0; i < 8; ++i) {
        const int x = pass ? 7 - i : i, before = pass ? x + 1 : x - 1;
        const uint64_t from = i ? reached.word[before] : 0;
        const uint64_t all = flood_word(free.word[x], (reached.word[x] | from) & free.word[x]);
        grew |= all != reached.word[x];
        reached.word[x] = all;
      }
  }
}

/// The same among the leaves of a block: bit x*256 + y*16 + z of 64 words.
ISOSHELL_HD inline void flood_block(const uint64_t free[64], uint64_t reached[64]) {
  constexpr uint64_t kLow = 0x0001000100010001ull;
  for (bool grew = true; grew;) {
    grew = false;
    for (int pass = 0; pass < 2; ++pass)
      for (int i = 0; i < 64; ++i) {
        const int w = pass ? 63 - i : i;
        uint64_t r = reached[w];
        if (w & 3) r |= reached[w - 1] >> 48;
        if ((w & 3) != 3) r |= reached[w + 1] << 48;
        if (w >= 4) r |= reached[w - 4];
        if (w < 60) r |= reached[w + 4];
        r &= free[w];
        for (uint64_t last = ~r; r != last;) {
          last = r;
          r |= free[w] & ((r << 1 & ~kLow) | (r >> 1 & ~(kLow << 15)) | r << 16 | r >> 16);
        }
        grew |= r != reached[w];
        reached[w] = r;
      }
  }
}

}  // namespace isoshell
