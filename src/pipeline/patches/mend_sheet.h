// A mesh on a sheet in which some cells give none.
#pragma once

#include <optional>

#include "pipeline/patches/mend_patches.h"

namespace isoshell {

/// The mesh of relaxed seeds on the sheet of which some cells are no disks, or some triangles intersect: as
/// mend_patches, with the sheet as a cut surface of one patch and no curves. Homes of its vertices are those of the
/// sheet's. `made`: the mesh that it is to replace, and what its optimisation did. None where the memory limit does not
/// allow it, or the sheet's own triangles intersect. Cost: as untangle_sheet, and as mend_patches.
std::optional<MendedPatches> mend_sheet(const PreparedSurface& p, const SeededMesh& made,
                                        const OptimizeReport& optimized, const PatchOptions& options, Run& run);

}  // namespace isoshell
