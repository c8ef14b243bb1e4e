// Better triangles of walls.
#pragma once

#include "features/walls/wall_mesh.h"

namespace isoshell {

/// Flips edges, moves vertices towards the middle of what is around them, splits the longest edges and coarsens again,
/// in turn, until there are so many vertices whose triangles are about as good as such changes make them. Result: the
/// same for every number of threads. Cost: some rounds over the mesh, together about a quarter of a millisecond a
/// vertex.
void even_out(WallMesh& mesh, int64_t vertices, const Context& context);

}  // namespace isoshell
