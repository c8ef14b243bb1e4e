#include "cpu/sheet/foot_simd.h"

#include "cpu/vector_versions.h"

namespace isoshell {
namespace {

constexpr int kLanes = FootSimd::kLanes;

struct Offset {
  double x, y, z;
};
ISOSHELL_INLINE Offset way(const FootSimd::Points& from, const FootSimd::Points& to, int i) {
  return {double(to.x[i] - from.x[i]), double(to.y[i] - from.y[i]), double(to.z[i] - from.z[i])};
}
/// Exact: differences take 24 bits.
ISOSHELL_INLINE double dot(const Offset& a, const Offset& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/// round_to_int, for values in 32 bits.
ISOSHELL_INLINE int32_t rounded(double x) { return int32_t(__builtin_floor(x + 0.5)); }

// The foot is a + v ab + w ac, or b + v bc; v and w have one divisor. Branches are choices between two values: of those
// that hold, the last one counts. Not plain are needles and triangles without one of their sides.
ISOSHELL_VECTOR_VERSIONS void find_simd(FootSimd& s, int count, double* is_plain) {
  for (int i = 0; i < count; ++i) {
    const Offset ab = way(s.a, s.b, i), ac = way(s.a, s.c, i), ap = way(s.a, s.p, i), bp = way(s.b, s.p, i),
                 cp = way(s.c, s.p, i), bc = way(s.b, s.c, i);
    const double d1 = dot(ab, ap), d2 = dot(ac, ap), d3 = dot(ab, bp), d4 = dot(ac, bp), d5 = dot(ab, cp),
                 d6 = dot(ac, cp);
    const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4, sum = va + vb + vc;
    const bool at_a = (d1 <= 0) & (d2 <= 0), at_b = (d3 >= 0) & (d4 <= d3), at_c = (d6 >= 0) & (d5 <= d6);
    const bool on_ab = (vc <= 0) & (d1 >= 0) & (d3 <= 0), on_ac = (vb <= 0) & (d2 >= 0) & (d6 <= 0),
               on_bc = (va <= 0) & (d4 - d3 >= 0) & (d5 - d6 >= 0);
    double v = vb, w = vc, all = sum, from_b = 0;
    v = on_bc ? d4 - d3 : v, w = on_bc ? 0 : w, all = on_bc ? (d4 - d3) + (d5 - d6) : all, from_b = on_bc ? 1 : from_b;
    v = on_ac ? 0 : v, w = on_ac ? d2 : w, all = on_ac ? d2 - d6 : all, from_b = on_ac ? 0 : from_b;
    v = at_c ? 0 : v, w = at_c ? 1 : w, all = at_c ? 1 : all, from_b = at_c ? 0 : from_b;
    v = on_ab ? d1 : v, w = on_ab ? 0 : w, all = on_ab ? d1 - d3 : all, from_b = on_ab ? 0 : from_b;
    v = at_b ? 1 : v, w = at_b ? 0 : w, all = at_b ? 1 : all, from_b = at_b ? 0 : from_b;
    v = at_a ? 0 : v, w = at_a ? 0 : w, all = at_a ? 1 : all, from_b = at_a ? 0 : from_b;
    const bool inside = !(at_a | at_b | at_c | on_ab | on_ac | on_bc);
    const bool needle = inside & (sum <= 0x1p-40 * dot(ab, ab) * dot(ac, ac));
    const double divisor = all > 0 ? all : 1, by_ab = v / divisor, by_ac = w / divisor;
    const bool plain = (all > 0) & !needle & (by_ab * by_ab + by_ac * by_ac <= 4);
    const double t = plain ? by_ab : 0, u = plain ? by_ac : 0;
    is_plain[i] = plain ? 1 : 0;
    const Offset e = {from_b > 0 ? bc.x : ab.x, from_b > 0 ? bc.y : ab.y, from_b > 0 ? bc.z : ab.z};
    const int32_t x = rounded(t * e.x + u * ac.x) + (from_b > 0 ? s.b.x[i] : s.a.x[i]);
    const int32_t y = rounded(t * e.y + u * ac.y) + (from_b > 0 ? s.b.y[i] : s.a.y[i]);
    const int32_t z = rounded(t * e.z + u * ac.z) + (from_b > 0 ? s.b.z[i] : s.a.z[i]);
    s.foot.x[i] = x, s.foot.y[i] = y, s.foot.z[i] = z;
    const double to_x = x - s.p.x[i], to_y = y - s.p.y[i], to_z = z - s.p.z[i];
    s.distance_sq[i] = to_x * to_x + to_y * to_y + to_z * to_z;
  }
}

}  // namespace

void FootSimd::find(int count) {
  double is_plain[kLanes];
  find_simd(*this, count, is_plain);
  for (int i = 0; i < count; ++i) {
    if (is_plain[i] > 0) continue;
    const PointQ8 q = closest_point_on_triangle(p.at(i), a.at(i), b.at(i), c.at(i));
    foot.set(i, q);
    distance_sq[i] = double(distance_sq_q16(q, p.at(i)));
  }
}

}  // namespace isoshell
