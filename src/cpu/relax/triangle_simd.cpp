#include "cpu/relax/triangle_simd.h"

namespace isoshell {
namespace {

/// Components of an area vector below it have squares whose sum is exact in a double, and its root is never rounded up
/// to an integer.
constexpr int32_t kAreaReach = 1 << 25;

/// False when some areas are too large; those are wrong then.
ISOSHELL_VECTOR_VERSIONS bool measure_simd(TriangleSimd& t) {
  const int n = t.count;
  uint32_t misfits = 0;
  for (int i = 0; i < n; ++i) {
    const Local a = t.corner[0].at(i), b = t.corner[1].at(i), c = t.corner[2].at(i);
    const Shape32 shape = shape_of(a, b, c);
    t.sum.x[i] = shape.sum.x, t.sum.y[i] = shape.sum.y, t.sum.z[i] = shape.sum.z;
    t.squares[i] = shape.squares;
  }
  for (int i = 0; i < n; ++i) {
    const Local a = t.corner[0].at(i), b = t.corner[1].at(i), c = t.corner[2].at(i);
    const Local u = {b.x - a.x, b.y - a.y, b.z - a.z}, v = {c.x - a.x, c.y - a.y, c.z - a.z};
    const Local area = {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
    misfits |= beyond(kAreaReach, area);
    const double x = area.x, y = area.y, z = area.z;
    t.area2[i] = uint32_t(int32_t(__builtin_sqrt(x * x + y * y + z * z)));
  }
  return misfits == 0;
}

uint32_t area2_of(Local a, Local b, Local c) {
  const Vec64 n = cross({b.x - a.x, b.y - a.y, b.z - a.z}, {c.x - a.x, c.y - a.y, c.z - a.z});
  return uint32_t(isqrt(uint64_t(dot(n, n))));
}

}  // namespace

void TriangleSimd::measure() {
  if (measure_simd(*this)) return;
  for (int i = 0; i < count; ++i) area2[i] = area2_of(corner[0].at(i), corner[1].at(i), corner[2].at(i));
}

}  // namespace isoshell
