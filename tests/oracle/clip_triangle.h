// Oracle: the part of a triangle that is nearest to one of a few seeds, by clipping the polygon plane by plane in
// double.
#pragma once

#include <array>
#include <cmath>
#include <vector>

namespace isoshell::oracle {

using Point = std::array<double, 3>;

inline double distance_sq(const Point& a, const Point& b) {
  double d = 0;
  for (int i = 0; i < 3; ++i) d += (a[i] - b[i]) * (a[i] - b[i]);
  return d;
}

/// Corners of the part of `polygon` at least as near to `own` as to `other`.
inline std::vector<Point> clip_to_nearer(const std::vector<Point>& polygon, const Point& own, const Point& other) {
  std::vector<Point> out;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Point &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double fa = distance_sq(a, own) - distance_sq(a, other), fb = distance_sq(b, own) - distance_sq(b, other);
    if (fa <= 0) out.push_back(a);
    if ((fa < 0 && fb > 0) || (fa > 0 && fb < 0)) {
      const double t = fa / (fa - fb);
      out.push_back({a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])});
    }
  }
  return out;
}

struct Moments {
  double area2 = 0;         ///< doubled area
  Point first = {0, 0, 0};  ///< doubled integral of x
  double second = 0;        ///< doubled integral of |x|^2
};

inline Moments moments(const std::vector<Point>& polygon) {
  Moments m;
  for (size_t i = 2; i < polygon.size(); ++i) {
    const Point &a = polygon[0], &b = polygon[i - 1], &c = polygon[i];
    Point u, v, sum;
    double squares = 0;
    for (int k = 0; k < 3; ++k) {
      u[k] = b[k] - a[k];
      v[k] = c[k] - a[k];
      sum[k] = a[k] + b[k] + c[k];
      squares += a[k] * a[k] + b[k] * b[k] + c[k] * c[k] + sum[k] * sum[k];
    }
    const double nx = u[1] * v[2] - u[2] * v[1], ny = u[2] * v[0] - u[0] * v[2], nz = u[0] * v[1] - u[1] * v[0];
    const double area2 = std::sqrt(nx * nx + ny * ny + nz * nz);
    m.area2 += area2;
    for (int k = 0; k < 3; ++k) m.first[k] += area2 * sum[k] / 3;
    m.second += area2 * squares / 12;
  }
  return m;
}

}  // namespace isoshell::oracle
