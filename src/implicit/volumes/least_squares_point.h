// The point nearest to several planes.
#pragma once

#include <vector>

#include "isoshell/advanced/lattice.h"

namespace isoshell {

struct WeightedPlane {
  WorldPoint normal;  ///< of length 1
  double height;      ///< along the normal
  double weight;
};

struct LeastSquaresPoint {
  WorldPoint at;
  WorldPoint along;  ///< of an edge: of length 1, the one direction that no plane decides; otherwise 0
};

/// Of all points for which the weighted sum of squared distances from the planes is least, the one nearest to `from`.
/// Directions whose eigenvalue is below a part `least_eigenvalue` of the largest are left as they are at `from`: so
/// planes that are nearly parallel move it along their normal only, and those around an edge across the edge only.
LeastSquaresPoint least_squares_point(const std::vector<WeightedPlane>& planes, const WorldPoint& from,
                                      double least_eigenvalue);

}  // namespace isoshell
