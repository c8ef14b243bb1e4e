// The plane nearest to some points.
#pragma once

#include <vector>

#include "implicit/points/point_tree.h"

namespace isoshell {

/// Direction in which the symmetric matrix (xx, xy, xz, yy, yz, zz) is smallest, by Jacobi rotations.
WorldPoint smallest_direction(const double m[6]);

/// A plane through points: its normal, of either sign, a point of it, and the part of the points' scatter that is off
/// the plane.
struct PlaneFit {
  WorldPoint normal, mean;
  double off;
};
PlaneFit fit_plane(const std::vector<WorldPoint>& position, const std::vector<PointTree::Near>& near);

}  // namespace isoshell
