// Closest point of a triangle to a position, on the lattice. Floating point follows here and decides nothing: every
// operation is + - * / on doubles in a fixed order, hence the same bits everywhere, and the result is rounded to q8
// once.
#pragma once

#include "isoshell/advanced/lattice.h"
#include "isoshell/advanced/lattice_surface.h"
#include "voxel/exact_int.h"

namespace isoshell {

/// Nearest integer, halves up.
ISOSHELL_HD inline int32_t round_to_int(double x) {
  const double shifted = x + 0.5;
  const int64_t cut = int64_t(shifted);
  return int32_t(cut - (double(cut) > shifted));
}

/// A difference of positions in the 32 bits that it takes: products of two such are one instruction.
struct Offset32 {
  int32_t x, y, z;
};
ISOSHELL_HD inline Offset32 offset_between(PointQ8 from, PointQ8 to) {
  return {to.x - from.x, to.y - from.y, to.z - from.z};
}
ISOSHELL_HD inline int64_t dot(Offset32 a, Offset32 b) {
  return int64_t(a.x) * b.x + int64_t(a.y) * b.y + int64_t(a.z) * b.z;
}

/// The point of the segment ab closest to p, rounded to q8.
ISOSHELL_HD inline PointQ8 closest_point_on_segment(PointQ8 p, PointQ8 a, PointQ8 b) {
  const Offset32 e = offset_between(a, b);
  const double at = double(dot(e, offset_between(a, p))), length_sq = double(dot(e, e));
  if (at <= 0) return a;
  if (at >= length_sq) return b;
  const double t = at / length_sq;
  return {a.x + round_to_int(t * double(e.x)), a.y + round_to_int(t * double(e.y)),
          a.z + round_to_int(t * double(e.z))};
}

/// The point of the closed triangle abc closest to p, rounded to q8; triangles without area are segments or points.
/// The six dot products are exact (differences < 2^24), so only ratios round. After Ericson, Real-Time Collision
/// Detection, 5.1.5.
ISOSHELL_HD inline PointQ8 closest_point_on_triangle(PointQ8 p, PointQ8 a, PointQ8 b, PointQ8 c) {
  const Offset32 ab = offset_between(a, b), ac = offset_between(a, c), ap = offset_between(a, p),
                 bp = offset_between(b, p), cp = offset_between(c, p);
  const double d1 = double(dot(ab, ap)), d2 = double(dot(ac, ap)), d3 = double(dot(ab, bp)), d4 = double(dot(ac, bp)),
               d5 = double(dot(ab, cp)), d6 = double(dot(ac, cp));
  const auto along = [&](PointQ8 from, Offset32 e, double t) {
    return PointQ8{from.x + round_to_int(t * double(e.x)), from.y + round_to_int(t * double(e.y)),
                   from.z + round_to_int(t * double(e.z))};
  };
  if (d1 <= 0 && d2 <= 0) return a;
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return along(a, ab, d1 / (d1 - d3));
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return along(a, ac, d2 / (d2 - d6));
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
    return along(b, offset_between(b, c), (d4 - d3) / ((d4 - d3) + (d5 - d6)));
  const double sum = va + vb + vc;
  // A needle: what is left of the cancelling products is noise, and its edges are as near as its inside.
  if (sum <= 0x1p-40 * double(dot(ab, ab)) * double(dot(ac, ac))) {
    PointQ8 best = closest_point_on_segment(p, a, b);
    for (const PointQ8 q : {closest_point_on_segment(p, b, c), closest_point_on_segment(p, c, a)})
      if (distance_sq_q16(p, q) < distance_sq_q16(p, best)) best = q;
    return best;
  }
  const double v = vb / sum, w = vc / sum;
  return {a.x + round_to_int(v * double(ab.x) + w * double(ac.x)),
          a.y + round_to_int(v * double(ab.y) + w * double(ac.y)),
          a.z + round_to_int(v * double(ab.z) + w * double(ac.z))};
}

}  // namespace isoshell
