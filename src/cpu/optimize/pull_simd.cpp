#include "cpu/optimize/pull_simd.h"

#include "core/vector_versions.h"

namespace isoshell {
namespace {

using namespace optimize;

ISOSHELL_INLINE Vector way(const PullSimd::Points& from, const PullSimd::Points& to, int i) {
  return {double(to.x[i] - from.x[i]), double(to.y[i] - from.y[i]), double(to.z[i] - from.z[i])};
}

// foot_on_triangle, weight_of and add, where none of their other ways is taken: conditions become ones and zeros.
ISOSHELL_VECTOR_VERSIONS void find_simd(PullSimd& s, const PullOptions& options) {
  const bool weighs = options.rms_q8 > 0;
  const double rms = weighs ? options.rms_q8 : 1, far_sq = options.far_q8 * options.far_q8, tail = options.tail_of_rms;
  for (int i = 0; i < PullSimd::kLanes; ++i) {
    const Vector ab = way(s.a, s.b, i), ac = way(s.a, s.c, i), aq = way(s.a, s.sample, i), bq = way(s.b, s.sample, i),
                 cq = way(s.c, s.sample, i);
    const double d1 = dot(ab, aq), d2 = dot(ac, aq), d3 = dot(ab, bq), d4 = dot(ac, bq), d5 = dot(ab, cq),
                 d6 = dot(ac, cq);
    const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
    const bool at_corner = ((d1 <= 0) & (d2 <= 0)) | ((d3 >= 0) & (d4 <= d3)) | ((d6 >= 0) & (d5 <= d6));
    const bool on_edge = ((vc <= 0) & (d1 >= 0) & (d3 <= 0)) | ((vb <= 0) & (d2 >= 0) & (d6 <= 0)) |
                         ((va <= 0) & (d4 - d3 >= 0) & (d5 - d6 >= 0));
    const double sum = va + vb + vc, v = vb / sum, w = vc / sum, u = 1 - v - w;
    const Vector rest = aq - (v * ab + w * ac);
    const double distance_sq = dot(rest, rest);
    const Vector n = cross(ab, ac);
    const double n_sq = dot(n, n);
    const Vector normal = 1 / rounded_sqrt(n_sq > 0 ? n_sq : 1) * n;
    const double along = dot(rest, normal);
    const bool beyond = (distance_sq > 1) & (along * along < 0.96 * distance_sq) & (along * along > 0.04 * distance_sq);
    const bool inside = (u > 0) & (v > 0) & (w > 0) & (distance_sq <= far_sq);
    s.is_inside[i] = inside & !at_corner & !on_edge & !beyond ? 1 : 0;
    s.distance_sq[i] = distance_sq;
    const double part = rounded_sqrt(distance_sq) / rms;
    const double near = part * kNearWeight > 1 ? 1 / part : kNearWeight;
    const double beyond_tail = part / tail, square = beyond_tail * beyond_tail;
    const double rising = 1 / tail * (options.steep_tails ? square * square : square);
    const double far = rising < kLargestWeight ? rising : kLargestWeight;
    const double by_residual = part <= tail ? near : far, all = weighs ? by_residual : 1;
    s.weight[0][i] = all * u, s.weight[1][i] = all * v, s.weight[2][i] = all * w;
    for (int k = 0; k < 3; ++k) {
      s.pull[k][i] = s.weight[k][i] * along * kPullScale;
      s.weight[k][i] *= kPullScale;
    }
  }
}

}  // namespace

void PullSimd::find(const PullOptions& options) { find_simd(*this, options); }

}  // namespace isoshell
