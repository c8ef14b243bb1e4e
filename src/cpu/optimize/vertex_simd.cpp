#include "cpu/optimize/vertex_simd.h"

#include "core/vector_versions.h"

namespace isoshell {
namespace {

using namespace optimize;

/// Not where no triangle is: adding a zero could change the sign of one.
ISOSHELL_INLINE void add_to(double& sum, double value, double is_there) { sum = is_there > 0 ? sum + value : sum; }

// The operations of unit and to_equilateral_corner in their order; branches are choices between two values.
template <bool kEven, bool kPull>
ISOSHELL_INLINE void add_triangles(VertexSimd& s, double evenness) {
  for (int i = 0; i < VertexSimd::kLanes; ++i) {
    const Vector b = {double(s.to_b.x[i]), double(s.to_b.y[i]), double(s.to_b.z[i])};
    const Vector c = {double(s.to_c.x[i]), double(s.to_c.y[i]), double(s.to_c.z[i])};
    const Vector n = cross(b, c);
    const double n_sq = dot(n, n);
    const Vector d = 1 / rounded_sqrt(n_sq > 0 ? n_sq : 1) * n;
    const Vector middle = 0.5 * (b + c), across = cross(d, c - b);
    const Vector arm = (1.0 / 3) * (0.8660254037844386 * across - middle);
    const double arm_sq = dot(arm, arm);
    double scale = 1;
    if (kEven) scale = (1 - evenness) + evenness * s.radius_q8[i] / rounded_sqrt(arm_sq > 0 ? arm_sq : 1);
    const Vector to_middle = (2.0 / 3) * middle, to_corner = to_middle + scale * arm;
    const double there = s.is_there[i], w = kPull ? s.weight[i] : 1;
    add_to(s.corners.x[i], arm_sq > 0 ? to_corner.x : to_middle.x, there);
    add_to(s.corners.y[i], arm_sq > 0 ? to_corner.y : to_middle.y, there);
    add_to(s.corners.z[i], arm_sq > 0 ? to_corner.z : to_middle.z, there);
    add_to(s.normal.x[i], n.x, there);
    add_to(s.normal.y[i], n.y, there);
    add_to(s.normal.z[i], n.z, there);
    add_to(s.xx[i], w * d.x * d.x, there);
    add_to(s.xy[i], w * d.x * d.y, there);
    add_to(s.xz[i], w * d.x * d.z, there);
    add_to(s.yy[i], w * d.y * d.y, there);
    add_to(s.yz[i], w * d.y * d.z, there);
    add_to(s.zz[i], w * d.z * d.z, there);
    if (kPull) {
      add_to(s.pulls.x[i], s.pull[i] * d.x, there);
      add_to(s.pulls.y[i], s.pull[i] * d.y, there);
      add_to(s.pulls.z[i], s.pull[i] * d.z, there);
    }
  }
}

ISOSHELL_VECTOR_VERSIONS void add_simd(VertexSimd& s) { add_triangles<false, false>(s, 0); }
ISOSHELL_VECTOR_VERSIONS void add_even_simd(VertexSimd& s, double evenness) { add_triangles<true, false>(s, evenness); }
ISOSHELL_VECTOR_VERSIONS void add_pulls_simd(VertexSimd& s) { add_triangles<false, true>(s, 0); }
ISOSHELL_VECTOR_VERSIONS void add_even_pulls_simd(VertexSimd& s, double evenness) {
  add_triangles<true, true>(s, evenness);
}

}  // namespace

void VertexSimd::clear() {
  for (int i = 0; i < kLanes; ++i) {
    corners.x[i] = corners.y[i] = corners.z[i] = normal.x[i] = normal.y[i] = normal.z[i] = 0;
    pulls.x[i] = pulls.y[i] = pulls.z[i] = xx[i] = xy[i] = xz[i] = yy[i] = yz[i] = zz[i] = 0;
    radius_q8[i] = 1;
  }
}

void VertexSimd::add(double evenness) { evenness > 0 ? add_even_simd(*this, evenness) : add_simd(*this); }
void VertexSimd::add_with_pulls(double evenness) {
  evenness > 0 ? add_even_pulls_simd(*this, evenness) : add_pulls_simd(*this);
}

}  // namespace isoshell
