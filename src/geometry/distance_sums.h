// The stage `distance`: how far samples of one mesh are from another one, summed.
#pragma once

#include "geometry/triangle_grid.h"
#include "isoshell/backend.h"

namespace isoshell {

/// World units, and degrees between normals, 0 to 90.
struct DistanceSums {
  double sum = 0, sum_sq = 0, max_sq = 0;  ///< of area samples; of vertices, too, for the largest
  double turn_sum_deg = 0, turn_max_deg = 0;
};

template <>
constexpr bool kHasNoPadding<DistanceSums> = sizeof(DistanceSums) == 5 * sizeof(double);

/// Which places of a mesh, and what their normals are compared with.
struct DistancePlaces {
  int64_t samples = 0;        ///< one in each of so many strata of equal area, along the triangles
  int64_t vertex_stride = 1;  ///< the vertices 0, stride, 2 stride ...
  double diagonal = 0;        ///< of the box around the reference
  bool best_aligned = false;  ///< DistanceOptions::exact, for the normals
};

/// Result: the same on every backend and for every number of threads; measure_distance says of what. Runs on the host
/// where the device has too little memory. Cost: a search a place, two beside creases; on a device 60 bytes a triangle
/// of each mesh, at most 170. Throws: interrupted.
DistanceSums sum_distances(const TriangleMesh& from, const TriangleGrid& to, const DistancePlaces& places,
                           Context& context);

}  // namespace isoshell
