// The place of a source that a point of another surface takes its values from.
#pragma once

#include <cmath>

#include "geometry/triangle_grid.h"

namespace isoshell {

/// The nearest point of the source, unless a triangle that looks along the normal is within half an edge's length
/// beyond it: then the nearest of such triangles. So two sides of a thin wall stay apart.
inline MeshPoint facing_point(const TriangleGrid& grid, WorldPoint p, const MeshPoint& nearest, WorldPoint normal,
                              double edge_length) {
  constexpr double kFarther = 0.5;
  if (grid.is_facing(nearest.triangle, normal)) return nearest;
  const MeshPoint facing = grid.nearest_facing(p, normal, std::sqrt(nearest.distance_sq) + kFarther * edge_length);
  return facing.triangle == MeshPoint::kNoTriangle ? nearest : facing;
}
inline MeshPoint facing_point(const TriangleGrid& grid, WorldPoint p, WorldPoint normal, double edge_length) {
  return facing_point(grid, p, grid.nearest(p), normal, edge_length);
}

}  // namespace isoshell
