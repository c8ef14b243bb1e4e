#include "cpu/optimize/pull_simd.h"

#include "core/vector_versions.h"

namespace isoshell {
namespace {

using namespace optimize;

ISOSHELL_INLINE double smaller(double a, double b) { return a < b ? a : b; }

// foot_on_triangle, weight_of and add, where none of their other ways is taken: conditions become ones and zeros.
template <bool kWeighs, bool kSteep>
ISOSHELL_INLINE void find(PullSimd& s, int begin, int end, const PullSimd::Triangle& t, const PullOptions& options) {
  const double rms = options.rms_q8, far_sq = options.far_q8 * options.far_q8, tail = options.tail_of_rms,
               tail_weight = 1 / tail;
  const Vector a = t.a, ab = t.ab, ac = t.ac, normal = t.normal;
  const int count = (end - begin + PullSimd::kTogether - 1) / PullSimd::kTogether * PullSimd::kTogether;
  for (int n = 0; n < count; ++n) {
    const int i = begin + n;
    const Vector aq = Vector{s.x[i], s.y[i], s.z[i]} - a, bq = aq - ab, cq = aq - ac;
    const double d1 = dot(ab, aq), d2 = dot(ac, aq), d3 = dot(ab, bq), d4 = dot(ac, bq), d5 = dot(ab, cq),
                 d6 = dot(ac, cq);
    const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
    const bool at_corner = ((d1 <= 0) & (d2 <= 0)) | ((d3 >= 0) & (d4 <= d3)) | ((d6 >= 0) & (d5 <= d6));
    const bool on_edge = ((vc <= 0) & (d1 >= 0) & (d3 <= 0)) | ((vb <= 0) & (d2 >= 0) & (d6 <= 0)) |
                         ((va <= 0) & (d4 - d3 >= 0) & (d5 - d6 >= 0));
    const double sum = va + vb + vc, v = vb / sum, w = vc / sum, u = 1 - v - w;
    const Vector rest = aq - (v * ab + w * ac);
    const double distance_sq = dot(rest, rest);
    const double along = dot(rest, normal);
    const bool beyond = (distance_sq > 1) & (along * along < 0.96 * distance_sq) & (along * along > 0.04 * distance_sq);
    const bool inside = (u > 0) & (v > 0) & (w > 0) & (distance_sq <= far_sq);
    s.is_inside[i] = (inside & !at_corner & !on_edge & !beyond) ? 1 : 0;
    s.distance_sq[i] = distance_sq;
    double all = 1;
    if (kWeighs) {
      const double part = rounded_sqrt(distance_sq > 0 ? distance_sq : 0) / rms;
      // Weights near the mesh fall and those in the tails rise, from the same one on: the larger one counts.
      const double beyond_tail = part / tail, square = beyond_tail * beyond_tail;
      const double near = smaller(1 / part, kNearWeight),
                   far = smaller(tail_weight * (kSteep ? square * square : square), kLargestWeight);
      all = near < far ? far : near;
    }
    s.weight[0][i] = all * u, s.weight[1][i] = all * v, s.weight[2][i] = all * w;
    for (int k = 0; k < 3; ++k) {
      s.pull[k][i] = s.weight[k][i] * along * kPullScale;
      s.weight[k][i] *= kPullScale;
    }
  }
}

using Triangle = PullSimd::Triangle;
ISOSHELL_VECTOR_VERSIONS void find_simd(PullSimd& s, int begin, int end, const Triangle& t, const PullOptions& o) {
  find<true, false>(s, begin, end, t, o);
}
ISOSHELL_VECTOR_VERSIONS void find_steep_simd(PullSimd& s, int begin, int end, const Triangle& t,
                                              const PullOptions& o) {
  find<true, true>(s, begin, end, t, o);
}
ISOSHELL_VECTOR_VERSIONS void find_equal_simd(PullSimd& s, int begin, int end, const Triangle& t,
                                              const PullOptions& o) {
  find<false, false>(s, begin, end, t, o);
}

ISOSHELL_INLINE Vector chosen(bool first, Vector a, Vector b) {
  return {first ? a.x : b.x, first ? a.y : b.y, first ? a.z : b.z};
}
ISOSHELL_INLINE double part_of(double length, double of) { return of > 0 ? length / of : 0; }

// The ways of foot_on_triangle from the last one to the first, each in place of what came before it.
ISOSHELL_VECTOR_VERSIONS void find_far_simd(FarSimd& s, PointQ8 sample, int count) {
  const Vector q = {double(sample.x), double(sample.y), double(sample.z)};
  for (int i = 0; i < count; ++i) {
    const Vector a = {s.a.x[i], s.a.y[i], s.a.z[i]}, b = {s.b.x[i], s.b.y[i], s.b.z[i]},
                 c = {s.c.x[i], s.c.y[i], s.c.z[i]};
    const Vector ab = b - a, ac = c - a, aq = q - a, bq = q - b, cq = q - c;
    const double d1 = dot(ab, aq), d2 = dot(ac, aq), d3 = dot(ab, bq), d4 = dot(ac, bq), d5 = dot(ab, cq),
                 d6 = dot(ac, cq);
    const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
    const double sum = va + vb + vc, v = vb / sum, w = vc / sum;
    Vector rest = aq - (v * ab + w * ac);
    rest = chosen((va <= 0) & (d4 - d3 >= 0) & (d5 - d6 >= 0), bq - part_of(d4 - d3, (d4 - d3) + (d5 - d6)) * (ac - ab),
                  rest);
    rest = chosen((vb <= 0) & (d2 >= 0) & (d6 <= 0), aq - part_of(d2, d2 - d6) * ac, rest);
    rest = chosen((d6 >= 0) & (d5 <= d6), cq, rest);
    rest = chosen((vc <= 0) & (d1 >= 0) & (d3 <= 0), aq - part_of(d1, d1 - d3) * ab, rest);
    rest = chosen((d3 >= 0) & (d4 <= d3), bq, rest);
    rest = chosen((d1 <= 0) & (d2 <= 0), aq, rest);
    s.distance_sq[i] = dot(rest, rest);
  }
}

}  // namespace

void FarSimd::find(PointQ8 sample, int count) { find_far_simd(*this, sample, count); }

PullSimd::Triangle::Triangle(PointQ8 a_, PointQ8 b, PointQ8 c)
    : a{double(a_.x), double(a_.y), double(a_.z)},
      ab(from_to(a_, b)),
      ac(from_to(a_, c)),
      normal(unit(normal_of(a_, b, c))) {}

void PullSimd::find(int begin, int end, const Triangle& triangle, const PullOptions& options) {
  const auto find_all = !(options.rms_q8 > 0) ? find_equal_simd : (options.steep_tails ? find_steep_simd : find_simd);
  find_all(*this, begin, end, triangle, options);
}

}  // namespace isoshell
