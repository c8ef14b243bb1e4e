// What samples above the insides of triangles ask for, many samples at a time: PullCorners of
// stages/optimize/optimize_samples.h in lanes.
#pragma once

#include "stages/optimize/optimize_samples.h"

namespace isoshell {

/// Samples, and what they ask of the corners of their triangles.
struct PullSimd {
  static constexpr int kLanes = 64;
  static constexpr int kTogether = 4;  ///< lanes that are found at once

  /// What a triangle's samples share.
  struct Triangle {
    Triangle(PointQ8 a, PointQ8 b, PointQ8 c);
    optimize::Vector a, ab, ac, normal;
  };

  double x[kLanes + kTogether] = {}, y[kLanes + kTogether] = {}, z[kLanes + kTogether] = {};
  /// 1 where the sample pulls along the triangle's normal from above its inside; for all others nothing counts.
  double is_inside[kLanes + kTogether];
  double distance_sq[kLanes + kTogether];
  double weight[3][kLanes + kTogether], pull[3][kLanes + kTogether];  ///< per corner; scaled by kPullScale

  void set(int i, PointQ8 p) { x[i] = p.x, y[i] = p.y, z[i] = p.z; }
  /// Finds what the samples from `begin` to `end` ask of their triangle, unless they are off-surface points. Lanes from
  /// `end` on, fewer than kTogether, are overwritten.
  void find(int begin, int end, const Triangle& triangle, const optimize::PullOptions& options);
};

/// Triangles, and how far a sample is from each: foot_on_triangle in lanes.
struct FarSimd {
  static constexpr int kLanes = 64;

  struct Points {
    double x[kLanes], y[kLanes], z[kLanes];
    void set(int i, PointQ8 p) { x[i] = p.x, y[i] = p.y, z[i] = p.z; }
  };
  Points a, b, c;
  double distance_sq[kLanes];

  /// The distances from the first `count` ones.
  void find(PointQ8 sample, int count);
};

}  // namespace isoshell
