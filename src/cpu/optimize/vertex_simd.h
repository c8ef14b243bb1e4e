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
  struct Vectors {
    double x[kLanes], y[kLanes], z[kLanes];
    optimize::Vector at(int i) const { return {x[i], y[i], z[i]}; }
  };
  Vectors corners, normal, pulls;
  double xx[kLanes], xy[kLanes], xz[kLanes], yy[kLanes], yz[kLanes], zz[kLanes];

  void clear();
  /// Adds the triangles, without their weights and pulls.
  void add(double evenness);
  void add_with_pulls(double evenness);

  optimize::FitSums sums(int i) const {
    return {corners.at(i), normal.at(i), {xx[i], xy[i], xz[i], yy[i], yz[i], zz[i]}, pulls.at(i)};
  }
};

}  // namespace isoshell
