// The angle between two half-planes that meet at an edge.
#pragma once

#include <algorithm>
#include <cmath>

#include "geometry/world_vector.h"

namespace isoshell {

/// Of the one through `p` and the other through `q`: 1 where they lie on one another, -1 where they are flat, and where
/// one of them is none because three points lie on a line.
inline double cosine_at_edge(const WorldPoint& u, const WorldPoint& v, const WorldPoint& p, const WorldPoint& q) {
  const WorldPoint along = v - u, a = cross(along, p - u), b = cross(along, q - u);
  const double size = std::sqrt(length_sq(a)) * std::sqrt(length_sq(b));
  return size > 0 ? std::clamp(dot(a, b) / size, -1., 1.) : -1;
}

}  // namespace isoshell
