// Patches in a plane, whose triangles can always be found.
#pragma once

#include <vector>

#include "features/cutting/cut_surface.h"
#include "isoshell/advanced/stages.h"

namespace isoshell {

/// Triangulates those of some patches that lie in a plane anew: their border, with the free seeds that are not too near
/// to it, has a Delaunay triangulation in that plane, in which no triangles overlap, however narrow the patch is.
/// Vertices keep their numbers, and free ones may have no triangles any more. Result: which patches that was done to.
/// In host memory. Cost: as triangulate_plane.
std::vector<char> triangulate_flat(const CutSurface& cut, const std::vector<char>& is_chosen, SeededMesh& made);

}  // namespace isoshell
