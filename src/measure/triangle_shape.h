// The shape of one triangle: what every measure of quality is made from.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/world_vector.h"

namespace isoshell {

struct TriangleShape {
  double q = 0;  ///< as in MeshQuality; 0 for a triangle without area
  double area = 0, longest = 0;
  std::array<double, 3> edge{}, angle_deg{};  ///< edge i runs from corner i, where angle i is

  double smallest_deg() const { return std::min({angle_deg[0], angle_deg[1], angle_deg[2]}); }
  double largest_deg() const { return std::max({angle_deg[0], angle_deg[1], angle_deg[2]}); }
};

/// As in MeshQuality, from twice the area, and from the sum of the edges and the longest one.
inline double triangle_quality(double twice_area, double around, double longest) {
  constexpr double kEquilateral = 3.4641016151377544;  // 6 / sqrt(3)
  return longest > 0 ? kEquilateral * (twice_area / around) / longest : 0;
}

inline TriangleShape shape_of(const WorldPoint& a, const WorldPoint& b, const WorldPoint& c) {
  constexpr double kDegrees = 57.29577951308232;
  const WorldPoint side[3] = {b - a, c - b, a - c};
  const double twice_area = length(cross(side[0], side[2]));
  TriangleShape shape;
  for (size_t i = 0; i < 3; ++i) {
    shape.edge[i] = length(side[i]);
    shape.angle_deg[i] = std::atan2(twice_area, -dot(side[i], side[(i + 2) % 3])) * kDegrees;
  }
  shape.longest = std::max({shape.edge[0], shape.edge[1], shape.edge[2]});
  const double around = shape.edge[0] + shape.edge[1] + shape.edge[2];
  shape.q = triangle_quality(twice_area, around, shape.longest);
  shape.area = twice_area / 2;
  return shape;
}

}  // namespace isoshell
