// A mesh of relaxed patches in which some are coarsened instead.
#pragma once

#include <optional>
#include <vector>

#include "features/angles/patch_mesh.h"

namespace isoshell {

/// The mesh of `relaxed` without the patches that are to be coarse, and these coarsened from the fine mesh, to as many
/// vertices as they had, and evened out. Curves that they share with relaxed patches have the seeds of these. None
/// where a vertex between such seeds cannot go, or coarse triangles meet relaxed ones then: `is_coarse` is set for the
/// patches beside its curve, or those of these triangles, at least for one more. Coarse triangles meet others only
/// where the fine ones met each other. Result: the same for every number of threads. In host memory. Cost: as coarsen
/// and even_out, of the coarse patches.
std::optional<PatchMesh> coarsen_patches(const CutSurface& cut, const PatchMesh& relaxed, std::vector<char>& is_coarse,
                                         const JoinOptions& options, const Context& context);

}  // namespace isoshell
