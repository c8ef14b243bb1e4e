// Cut surfaces with as many vertices as asked for.
#pragma once

#include "features/angles/patch_mesh.h"
#include "features/walls/wall_mesh.h"

namespace isoshell {

/// The fine triangles of all patches.
inline WallTriangles all_triangles_of(const CutSurface& cut) {
  return {cut.fine->triangles, cut.fine->source_face, cut.fine->position.size()};
}

/// Collapses edges and evens out what that leaves: triangles are not as even as relaxed ones. More vertices than asked
/// for where no edge can be collapsed, and fewer where the mesh has far fewer. Result: the same for every number of
/// threads. Cost: as coarsen and even_out.
void coarsen_walls(WallMesh& mesh, int64_t vertices, const Context& context);

/// Widens angles; where vertices on curves are then more than asked for, the count goes before angles. The mesh of a
/// frame that follows another keeps them.
JoinedPatches widened_to_count(PatchMesh mesh, const Context& context);
/// The same of patches that are put together first.
JoinedPatches widened_to_count(const CutSurface& cut, const SeededMesh& made, const JoinOptions& options,
                               const Context& context);

}  // namespace isoshell
