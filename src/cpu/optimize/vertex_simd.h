// Sums over the triangles around vertices, many vertices at a time: those of SmoothVertex and FitVertex of
// stages/optimize/optimize_smooth.h and optimize_fit.h in lanes.
#pragma once

#include "stages/optimize/optimize_fit.h"

namespace isoshell {

/// Vertices, and what the triangles around them ask for.
struct VertexSimd {
  static constexpr int kLanes = 16;

  // One triangle around each vertex.
  struct Ways {
    int32_t x[kLanes], y[kLanes], z[kLanes];
    void set(int i, PointQ8 from, PointQ8 to) { x[i] = to.x - from.x, y[i] = to.y - from.y, z[i] = to.z - from.z; }
  };
  Ways to_b, to_c;           ///< to its other two corners
  double is_there[kLanes];   ///< 1, or 0 where a vertex has no further triangle
  double radius_q8[kLanes];  ///< of the triangle that is to be there
  double weight[kLanes], pull[kLanes];

  // Sums over such.
  double corners_x[kLanes], corners_y[kLanes], corners_z[kLanes];
  double normal_x[kLanes], normal_y[kLanes], normal_z[kLanes];
  double pull_x[kLanes], pull_y[kLanes], pull_z[kLanes];
  double xx[kLanes], xy[kLanes], xz[kLanes], yy[kLanes], yz[kLanes], zz[kLanes];

  void clear();
  /// Adds the triangles, without their weights and pulls.
  void add(double evenness);
  void add_with_pulls(double evenness);

  optimize::FitSums sums(int i) const {
    return {{corners_x[i], corners_y[i], corners_z[i]},
            {normal_x[i], normal_y[i], normal_z[i]},
            {xx[i], xy[i], xz[i], yy[i], yz[i], zz[i]},
            {pull_x[i], pull_y[i], pull_z[i]}};
  }
};

}  // namespace isoshell
