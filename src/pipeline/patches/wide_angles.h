// The mesh of patches as one.
#pragma once

#include "features/angles/patch_mesh.h"
#include "pipeline/patches/patches.h"

namespace isoshell {

/// The patches put together, with better angles beside curves; it intersects itself no more than before.
JoinedPatches with_wide_angles(const PreparedSurface& p, const CutSurface& cut, const SeededMesh& made,
                               const PatchOptions& options, const RemeshReport& report, Context& context);

}  // namespace isoshell
