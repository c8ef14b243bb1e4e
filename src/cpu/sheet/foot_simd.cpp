#include "cpu/sheet/foot_simd.h"

#include "core/vector_versions.h"

namespace isoshell {
namespace {

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

/// Of a triangle abc and a position p: ab.ap, ac.ap, ab.bp, ac.bp, ab.cp and ac.cp, each exact.
struct FootProducts {
  double ab_ap, ac_ap, ab_bp, ac_bp, ab_cp, ac_cp;
};

/// Where closest_point_on_triangle lies: a + (v ab + w ac) / whole, or b + v bc / whole.
struct FootTerms {
  double v, w, whole;
  double from_b;  ///< 1 or 0: numbers of one width in a loop over lanes
  bool inside;    ///< on no side: there needles must be told apart
};

/// The cases of closest_point_on_triangle as choices between two values: of those that hold, the last one counts, which
/// is the first one there.
ISOSHELL_INLINE FootTerms foot_terms(const FootProducts& d) {
  const double vc = d.ab_ap * d.ac_bp - d.ab_bp * d.ac_ap, vb = d.ab_cp * d.ac_ap - d.ab_ap * d.ac_cp,
               va = d.ab_bp * d.ac_cp - d.ab_cp * d.ac_bp;
  const double past_b = d.ac_bp - d.ab_bp, past_c = d.ab_cp - d.ac_cp;
  const bool at_a = (d.ab_ap <= 0) & (d.ac_ap <= 0), at_b = (d.ab_bp >= 0) & (d.ac_bp <= d.ab_bp),
             at_c = (d.ac_cp >= 0) & (d.ab_cp <= d.ac_cp);
  const bool on_ab = (vc <= 0) & (d.ab_ap >= 0) & (d.ab_bp <= 0), on_ac = (vb <= 0) & (d.ac_ap >= 0) & (d.ac_cp <= 0),
             on_bc = (va <= 0) & (past_b >= 0) & (past_c >= 0);
  double v = vb, w = vc, whole = va + vb + vc, from_b = 0;
  v = on_bc ? past_b : v, w = on_bc ? 0 : w, whole = on_bc ? past_b + past_c : whole, from_b = on_bc ? 1 : from_b;
  v = on_ac ? 0 : v, w = on_ac ? d.ac_ap : w, whole = on_ac ? d.ac_ap - d.ac_cp : whole, from_b = on_ac ? 0 : from_b;
  v = at_c ? 0 : v, w = at_c ? 1 : w, whole = at_c ? 1 : whole, from_b = at_c ? 0 : from_b;
  v = on_ab ? d.ab_ap : v, w = on_ab ? 0 : w, whole = on_ab ? d.ab_ap - d.ab_bp : whole, from_b = on_ab ? 0 : from_b;
  v = at_b ? 1 : v, w = at_b ? 0 : w, whole = at_b ? 1 : whole, from_b = at_b ? 0 : from_b;
  v = at_a ? 0 : v, w = at_a ? 0 : w, whole = at_a ? 1 : whole, from_b = at_a ? 0 : from_b;
  return {v, w, whole, from_b, !(at_a | at_b | at_c | on_ab | on_ac | on_bc)};
}

/// The ratios of FootTerms. Not plain are needles, and triangles without one of their sides.
struct FootRatios {
  double v, w;
  bool is_plain;
};
ISOSHELL_INLINE FootRatios ratios(const FootTerms& foot, const Offset& ab, const Offset& ac) {
  const bool needle = foot.inside & (foot.whole <= 0x1p-40 * dot(ab, ab) * dot(ac, ac));
  const double divisor = foot.whole > 0 ? foot.whole : 1, v = foot.v / divisor, w = foot.w / divisor;
  const bool is_plain = (foot.whole > 0) & !needle & (v * v + w * w <= 4);
  return {is_plain ? v : 0, is_plain ? w : 0, is_plain};
}

ISOSHELL_VECTOR_VERSIONS void find_simd(FootSimd& s, int count, double* is_plain) {
  for (int i = 0; i < count; ++i) {
    const Offset ab = way(s.a, s.b, i), ac = way(s.a, s.c, i), ap = way(s.a, s.p, i), bp = way(s.b, s.p, i),
                 cp = way(s.c, s.p, i), bc = way(s.b, s.c, i);
    const FootTerms foot = foot_terms({dot(ab, ap), dot(ac, ap), dot(ab, bp), dot(ac, bp), dot(ab, cp), dot(ac, cp)});
    const FootRatios at = ratios(foot, ab, ac);
    is_plain[i] = at.is_plain ? 1 : 0;
    const bool from_b = foot.from_b > 0;
    const Offset side = {from_b ? bc.x : ab.x, from_b ? bc.y : ab.y, from_b ? bc.z : ab.z};
    const int32_t x = rounded(at.v * side.x + at.w * ac.x) + (from_b ? s.b.x[i] : s.a.x[i]);
    const int32_t y = rounded(at.v * side.y + at.w * ac.y) + (from_b ? s.b.y[i] : s.a.y[i]);
    const int32_t z = rounded(at.v * side.z + at.w * ac.z) + (from_b ? s.b.z[i] : s.a.z[i]);
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
