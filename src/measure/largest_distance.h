// How far a mesh is from another one at most.
#pragma once

#include "geometry/triangle_grid.h"
#include "isoshell/backend.h"
#include "isoshell/triangle_mesh.h"

namespace isoshell {

struct LargestDistance {
  double found = 0;    ///< at a point of the mesh
  double at_most = 0;  ///< at all of them
};

/// Of the points of all triangles to the mesh of the grid. A distance to one triangle is convex, so that no point of a
/// piece is farther from it than the piece's corners; pieces that may have a larger distance than was found are split.
/// `at_most` is no more than two thousandths larger, or a billionth of `diagonal`, unless there are too many pieces.
/// Result: the same for every number of threads. Cost: a search for each vertex and triangle and three for each split;
/// 400 bytes a triangle.
/// Throws: interrupted.
LargestDistance largest_distance(const TriangleMesh& mesh, const TriangleGrid& to, double diagonal,
                                 const Context& context);

}  // namespace isoshell
