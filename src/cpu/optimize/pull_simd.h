// What samples above the insides of triangles ask for, many samples at a time: PullCorners of
// stages/optimize/optimize_samples.h in lanes.
#pragma once

#include "stages/optimize/optimize_samples.h"

namespace isoshell {

/// Samples, and what they ask of the corners of their triangles.
struct PullSimd {
  static constexpr int kLanes = 64;

  struct Points {
    int32_t x[kLanes], y[kLanes], z[kLanes];
    void set(int i, PointQ8 p) { x[i] = p.x, y[i] = p.y, z[i] = p.z; }
  };
  Points sample, a, b, c;
  /// 1 where the sample pulls along the triangle's normal from above its inside; for all others nothing counts.
  double is_inside[kLanes];
  double distance_sq[kLanes];
  double weight[3][kLanes], pull[3][kLanes];  ///< per corner; scaled by kPullScale

  /// Finds what they ask for, unless they are off-surface points.
  void find(const optimize::PullOptions& options);
};

}  // namespace isoshell
