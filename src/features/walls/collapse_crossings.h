// Fine triangles that rounding to the lattice made meet.
#pragma once

#include "features/walls/wall_mesh.h"

namespace isoshell {

/// Collapses edges of triangles that meet others, the shortest ones first: where sheets of a surface are parted by less
/// than a step of the lattice, their fine triangles meet once they are rounded, and would go on doing so as they become
/// coarser. The mesh may have few vertices there afterwards; what cannot be collapsed goes on meeting. Throws:
/// interrupted. Cost: a look at all triangles for those that meet, and for each collapse one at those that it changes.
void collapse_crossings(WallMesh& mesh, const Context& context);

}  // namespace isoshell
