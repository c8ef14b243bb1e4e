// The arithmetic of voxel/cell_sum.h in 32 bits and without branches, for loops over lanes.
#pragma once

#include "cpu/vector_versions.h"
#include "voxel/cell_sum.h"

namespace isoshell {

// What is in 32 bits here fits them while the coordinates of corners and of seeds are below these.
constexpr int32_t kCornerReach = 1 << 12, kSeedReach = 1 << 13;

/// Points about a local origin, by lanes.
template <int kLanes>
struct LocalLanes {
  int32_t x[kLanes], y[kLanes], z[kLanes];
  void set(int i, Local u) { x[i] = u.x, y[i] = u.y, z[i] = u.z; }
  ISOSHELL_INLINE Local at(int i) const { return {x[i], y[i], z[i]}; }
};

/// Not 0 when a coordinate is not within the reach, a power of two.
ISOSHELL_INLINE uint32_t beyond(int32_t reach, Local u) {
  return (uint32_t(u.x + reach) | uint32_t(u.y + reach) | uint32_t(u.z + reach)) & ~uint32_t(2 * reach - 1);
}

/// nearer, for values in 32 bits.
ISOSHELL_INLINE int32_t bisector_value_32(Local v, Local a, Local b) {
  return (b.x - a.x) * (2 * v.x - (a.x + b.x)) + (b.y - a.y) * (2 * v.y - (a.y + b.y)) +
         (b.z - a.z) * (2 * v.z - (a.z + b.z));
}

/// crossing_q15, for values in 32 bits. Signs are masks: the compiler takes no loop with branches.
ISOSHELL_INLINE int32_t crossing(int32_t here, int32_t there) {
  const int32_t before = -here & here >> 31, after = there & -there >> 31;
  const uint32_t neither = (uint32_t(before | after) - 1) >> 31;
  return int32_t(float(kOneQ15) * (float(before) / (float(before) + float(after + int32_t(neither)))));
}

ISOSHELL_INLINE int32_t part_way(int32_t a, int32_t b, int32_t t_q15) {
  return a + (((b - a) * t_q15 + kOneQ15 / 2) >> 15);
}
ISOSHELL_INLINE Local part_way(Local a, Local b, int32_t t_q15) {
  return {part_way(a.x, b.x, t_q15), part_way(a.y, b.y, t_q15), part_way(a.z, b.z, t_q15)};
}

ISOSHELL_INLINE int32_t squares_of(int32_t p, int32_t q, int32_t r) {
  const int32_t sum = p + q + r;
  return p * p + q * q + r * r + sum * sum;
}
/// sum_of_squares, for values in 32 bits.
ISOSHELL_INLINE int32_t squares_of(Local p, Local q, Local r) {
  return squares_of(p.x, q.x, r.x) + squares_of(p.y, q.y, r.y) + squares_of(p.z, q.z, r.z);
}

/// A part in 1/32768 of an area below 2^31.
ISOSHELL_INLINE int32_t part_of(uint32_t area2, int32_t share_q15) {
  return int32_t(uint32_t(uint64_t(area2) * uint32_t(share_q15) >> 15));
}

}  // namespace isoshell
