// The points of a segment that are nearest to others.
#pragma once

#include <algorithm>
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
inline double segment_distance_sq(const WorldPoint& p, const WorldPoint& a, const WorldPoint& b) {
  return distance_sq(p, nearest_on_segment(p, a, b));
}
inline double distance_to_segment(const WorldPoint& p, const WorldPoint& a, const WorldPoint& b) {
  return std::sqrt(segment_distance_sq(p, a, b));
}

}  // namespace isoshell
