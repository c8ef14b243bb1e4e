// All patches of a cut surface with as many vertices as asked for, whatever they are like.
#pragma once

#include "features/angles/patch_mesh.h"
#include "features/walls/wall_mesh.h"

namespace isoshell {

/// The fine triangles of all patches.
inline WallTriangles all_triangles_of(const CutSurface& cut) {
  return {cut.fine->triangles, cut.fine->source_face, cut.fine->position.size()};
}

/// Coarsens the walls and evens them out: triangles are not as even as relaxed ones, and intersect where the walls' own
/// do only. More vertices than asked for where no edge can be collapsed, and fewer where `walls` have far fewer.
/// Result: the same for every number of threads. In host memory. Cost: as coarsen and even_out.
PatchMesh coarsen_walls(const CutSurface& cut, const WallTriangles& walls, const JoinOptions& options,
                        const Context& context);

/// Widens angles; where vertices on curves are then a tenth more than asked for, the count goes before angles. The mesh
/// of a frame that follows another keeps them.
JoinedPatches widened_to_count(PatchMesh mesh, const Context& context);
/// The same of patches that are put together first.
JoinedPatches widened_to_count(const CutSurface& cut, const SeededMesh& made, const JoinOptions& options,
                               const Context& context);

}  // namespace isoshell
