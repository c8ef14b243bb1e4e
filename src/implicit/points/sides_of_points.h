// The sides that points near a place lie on, and the distance from the surface that they make together.
#pragma once

#include "implicit/points/point_normals.h"

namespace isoshell {

/// A point and its normal, in voxels.
struct SidePoint {
  WorldPoint at, normal;
  double area;
};

class SidesOfPoints {
 public:
  /// `spacing_vox`: of the points.
  explicit SidesOfPoints(double spacing_vox) : spacing_(spacing_vox) {}

  /// The signed distance of a place from the surface of the points around it, the nearest of which is `nearest` away.
  double distance(const WorldPoint& place, const std::vector<SidePoint>& around, double nearest);

 private:
  struct Near {
    double away_sq;
    const SidePoint* point;
  };
  /// A plane, as seen from the place.
  struct Side {
    WorldPoint normal, foot;
    double distance;
  };

  void take_side(const WorldPoint& place, double reach);
  double value_at(const WorldPoint& from_place) const;
  double distance_from_planes() const;

  const double spacing_;
  std::vector<Near> near_;
  std::vector<Side> sides_;
};

}  // namespace isoshell
