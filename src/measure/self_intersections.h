// Where any mesh intersects itself, as it is stored.
#pragma once

#include <cstdint>
#include <vector>

#include "isoshell/backend.h"
#include "isoshell/triangle_mesh.h"

namespace isoshell {

struct SelfIntersections {
  int64_t pairs = 0;                ///< of triangles that meet outside of the corners that they share
  std::vector<uint32_t> triangles;  ///< that belong to one; ascending
};

/// Per vertex the smallest index of those at its position; -0 is 0.
std::vector<uint32_t> first_at_position(const std::vector<WorldPoint>& vertices);

/// Exactly tested, in double precision; touching counts. Vertices of one position are one, `first_at` says which.
/// Triangles whose corners lie on a line are left out, as are pairs with the same three corners. Positions of
/// referenced vertices are finite. Cost: a tree of boxes, and for each triangle a look at all whose boxes meet its own.
/// Throws: interrupted.
SelfIntersections find_self_intersections(const TriangleMesh& mesh, const std::vector<uint32_t>& first_at,
                                          Context& context);

}  // namespace isoshell
