// What SIMD versions of cut triangles share.
#pragma once

#include "core/vector_versions.h"
#include "voxel/cell_sum_32.h"

namespace isoshell {

/// Points about a local origin, by lanes.
template <int kLanes>
struct LocalLanes {
  int32_t x[kLanes], y[kLanes], z[kLanes];
  void set(int i, Local u) { x[i] = u.x, y[i] = u.y, z[i] = u.z; }
  ISOSHELL_INLINE Local at(int i) const { return {x[i], y[i], z[i]}; }
};

/// crossing_q15, for values in 32 bits. Signs are masks: the compiler takes no loop with branches.
ISOSHELL_INLINE int32_t crossing(int32_t here, int32_t there) {
  const int32_t before = -here & here >> 31, after = there & -there >> 31;
  const uint32_t neither = (uint32_t(before | after) - 1) >> 31;
  return int32_t(float(kOneQ15) * (float(before) / (float(before) + float(after + int32_t(neither)))));
}

/// A triangle by what its moments are made of, apart from its area: these fit 32 bits.
struct Shape32 {
  Local sum;
  uint32_t squares;
};
ISOSHELL_INLINE Shape32 shape_of(Local p, Local q, Local r) {
  return {corner_sum(p, q, r), sum_of_squares_32(p, q, r)};
}

ISOSHELL_INLINE PieceSum moments(int32_t mass, const Shape32& of) {
  return {mass, int64_t(mass) * of.sum.x, int64_t(mass) * of.sum.y, int64_t(mass) * of.sum.z,
          int64_t(mass) * int32_t(of.squares)};
}

/// SplitTriangle::corner: what the bisector of the seeds a, of p, and b cuts off the triangle (p, q, r) at p.
struct CornerCut {
  int32_t share_q15;  ///< of the triangle's area
  Shape32 shape;
};
ISOSHELL_INLINE CornerCut cut_corner(Local p, Local q, Local r, Local a, Local b) {
  const int32_t at = bisector_value_32(p, a, b);
  const int32_t t = crossing(at, bisector_value_32(q, a, b)), u = crossing(at, bisector_value_32(r, a, b));
  return {t * u >> 15, shape_of(p, between_32(p, q, t), between_32(p, r, u))};
}

}  // namespace isoshell
