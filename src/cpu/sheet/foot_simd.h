// Closest points of triangles to positions, many at a time: closest_point_on_triangle of voxel/closest_point.h in
// lanes.
#pragma once

#include "voxel/closest_point.h"

namespace isoshell {

/// Positions, a triangle for each, and the closest points.
struct FootSimd {
  static constexpr int kLanes = 128;
  struct Points {
    int32_t x[kLanes], y[kLanes], z[kLanes];
    void set(int i, PointQ8 q) { x[i] = q.x, y[i] = q.y, z[i] = q.z; }
    PointQ8 at(int i) const { return {x[i], y[i], z[i]}; }
  };

  Points p, a, b, c;
  Points foot;
  double distance_sq[kLanes];  ///< from p to the foot

  /// Finds the feet of the first `count`.
  void find(int count);
};

}  // namespace isoshell
