// Relaxed patches in which some cells give no mesh.
#pragma once

#include <optional>
#include <string>

#include "features/angles/patch_mesh.h"
#include "pipeline/patches/mesh_patches.h"

namespace isoshell {

/// Patches of which some cells were simplified.
struct MendedPatches {
  JoinedPatches joined;
  OptimizeReport optimize;   ///< of all that was optimised, the first time too
  SizingReport sizing = {};  ///< where it is asked for
};

/// The joined mesh of relaxed patches with as many vertices as are asked for. Cells with faults, and those beside them,
/// are simplified from the fine triangles instead, and so are those that the fine ones come to meet: in the end
/// triangles intersect where those of the input do, if anywhere. None where fine triangles intersect or a region is
/// inside out, and where the memory limit does not allow it. Warns of cells that were simplified. `faults`: as
/// mesh_patches found them. Cost: the dual once more, optimisation of the patches in which it puts vertices, that of
/// coarsening the fine triangles of these cells, and for each time that there are more a pass over all fine triangles.
std::optional<MendedPatches> mend_patches(const PreparedSurface& p, const CutSurface& cut, const PatchFaults& faults,
                                          const PatchOptions& options, Run& run);

/// The joined mesh of relaxed seeds, or why there is none.
struct MeshedPatches {
  JoinedPatches joined;
  DualReport dual;
  OptimizeReport optimize;
  std::string why_not;
};

/// mesh_patches, joined with angles widened, or mended; one that begins with the frame before is not mended.
MeshedPatches join_patches(const PreparedSurface& p, const CutSurface& cut, SeededMesh& made,
                           const PatchOptions& options, Run& run);

}  // namespace isoshell
