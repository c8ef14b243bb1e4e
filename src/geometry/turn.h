// Angles by operations that every backend rounds alike: the atan2 of libraries differs in the last bit.
#pragma once

#include <cmath>

#include "geometry/world_vector.h"

namespace isoshell {

/// Of 0 <= x <= 1. Three half-angles, atan x = 2 atan(x / (1 + sqrt(1 + x^2))), leave at most .0985, where the terms up
/// to x^15 are as good as doubles are.
ISOSHELL_HD inline double arc_tangent(double x) {
  for (int half = 0; half < 3; ++half) x /= 1 + std::sqrt(1 + x * x);
  double sum = 0;
  for (int power = 15; power >= 1; power -= 2) sum = 1. / power - x * x * sum;
  return 8 * x * sum;
}

/// Between the lines along a and b, 0 to 90 degrees; 0 where one of them has no length.
ISOSHELL_HD inline double angle_between_deg(const WorldPoint& a, const WorldPoint& b) {
  constexpr double kDegrees = 57.29577951308232;
  const double across = length(cross(a, b)), along = std::abs(dot(a, b));
  if (across == 0) return 0;
  return across <= along ? kDegrees * arc_tangent(across / along) : 90 - kDegrees * arc_tangent(along / across);
}

}  // namespace isoshell
