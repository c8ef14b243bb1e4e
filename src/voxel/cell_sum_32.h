// What voxel/cell_sum.h computes, in 32 bits: the same values while coordinates are below the reaches given here, about
// the middle of a leaf. For SIMD on the CPU, and for the device's threads.
#pragma once

#include "voxel/always_inline.h"
#include "voxel/cell_sum.h"

namespace isoshell {

constexpr int32_t kCornerReach = 1 << 12, kSeedReach = 1 << 13;

/// Not 0 when a coordinate is not within the reach, a power of two.
ISOSHELL_HD ISOSHELL_INLINE uint32_t beyond(int32_t reach, Local u) {
  return (uint32_t(u.x + reach) | uint32_t(u.y + reach) | uint32_t(u.z + reach)) & ~uint32_t(2 * reach - 1);
}

ISOSHELL_HD ISOSHELL_INLINE int32_t bisector_value_32(Local v, Local a, Local b) {
  return (b.x - a.x) * (2 * v.x - (a.x + b.x)) + (b.y - a.y) * (2 * v.y - (a.y + b.y)) +
         (b.z - a.z) * (2 * v.z - (a.z + b.z));
}

ISOSHELL_HD ISOSHELL_INLINE int32_t between_32(int32_t a, int32_t b, int32_t t_q15) {
  return a + (((b - a) * t_q15 + kOneQ15 / 2) >> 15);
}
ISOSHELL_HD ISOSHELL_INLINE Local between_32(Local a, Local b, int32_t t_q15) {
  return {between_32(a.x, b.x, t_q15), between_32(a.y, b.y, t_q15), between_32(a.z, b.z, t_q15)};
}

/// Below 2^32, for corners below 2^13 on each axis too.
ISOSHELL_HD ISOSHELL_INLINE uint32_t square_32(Local u) {
  return uint32_t(u.x * u.x) + uint32_t(u.y * u.y) + uint32_t(u.z * u.z);
}
ISOSHELL_HD ISOSHELL_INLINE uint32_t sum_of_squares_32(Local a, Local b, Local c) {
  return square_32(a) + square_32(b) + square_32(c) + square_32(corner_sum(a, b, c));
}

/// A part in 1/32768 of a doubled area below 2^31.
ISOSHELL_HD ISOSHELL_INLINE int32_t part_of(uint32_t area2, int32_t share_q15) {
  return int32_t(uint32_t(uint64_t(area2) * uint32_t(share_q15) >> 15));
}

}  // namespace isoshell
