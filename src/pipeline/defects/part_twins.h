// Edges and faces that would be there twice once patches are joined.
#pragma once

#include "features/cutting/cut_surface.h"
#include "isoshell/advanced/stages.h"

namespace isoshell {

/// Puts a vertex into every edge inside of a patch whose ends, joined, have another edge, and into one of two faces
/// with the same corners: the vertex of the surface in the patch that is nearest to the middle and no seed's home. An
/// edge or face in whose patch there is none stays as it is. Of edges that are all inside of patches the first one
/// stays. In host memory. Cost: sorts of the edges between fixed seeds, and a look at the patch of each vertex that is
/// put in.
void part_twins(const CutSurface& cut, SeededMesh& made);

}  // namespace isoshell
