// Fewer vertices of walls.
#pragma once

#include "features/walls/wall_mesh.h"

namespace isoshell {

/// Takes vertices into others until there are so many, each time where the longest edge that comes of it is the
/// shortest, in terms of the length aimed at there, and the walls lie about where they did, with the tips of what is
/// thin. Triangles whose edges are longer than half of those of the result keep angles of 10 degrees, or what they had,
/// as long as that leaves an edge to collapse that is not far longer than those; more vertices are left where none can
/// be. Where most go, the first ones do in blocks of space, by several threads; their number changes nothing. Cost: a
/// queue of the vertices, and for each that goes a look at the triangles around it and its neighbours.
void coarsen(WallMesh& mesh, int64_t vertices, const Context& context);

}  // namespace isoshell
