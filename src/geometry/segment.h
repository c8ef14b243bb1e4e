// The points of a segment that are nearest to others.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/world_vector.h"

namespace isoshell {

/// The nearest one to p, between a and b, is at a + part (b - a).
inline double nearest_part(const WorldPoint& p, const WorldPoint& a, const WorldPoint& b) {
  const double whole_sq = distance_sq(a, b);
  return whole_sq > 0 ? std::clamp(dot(p - a, b - a) / whole_sq, 0.0, 1.0) : 0;
}
inline WorldPoint nearest_on_segment(const WorldPoint& p, const WorldPoint& a, const WorldPoint& b) {
  return a + nearest_part(p, a, b) * (b - a);
}
/// The nearest points of two segments, on each one; of parallel ones some.
inline std::array<WorldPoint, 2> nearest_of_segments(const WorldPoint& a, const WorldPoint& b, const WorldPoint& c,
                                                     const WorldPoint& d) {
  const WorldPoint u = b - a, v = d - c, w = a - c;
  const double uu = length_sq(u), uv = dot(u, v), vv = length_sq(v), area_sq = uu * vv - uv * uv;
  const double along = area_sq > 0 ? std::clamp((uv * dot(v, w) - vv * dot(u, w)) / area_sq, 0.0, 1.0) : 0;
  const WorldPoint on_second = nearest_on_segment(a + along * u, c, d);
  const WorldPoint on_first = nearest_on_segment(on_second, a, b);
  return {on_first, nearest_on_segment(on_first, c, d)};
}
inline double segment_distance_sq(const WorldPoint& p, const WorldPoint& a, const WorldPoint& b) {
  return distance_sq(p, nearest_on_segment(p, a, b));
}
inline double distance_to_segment(const WorldPoint& p, const WorldPoint& a, const WorldPoint& b) {
  return std::sqrt(segment_distance_sq(p, a, b));
}

}  // namespace isoshell
