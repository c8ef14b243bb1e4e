// A mesh of relaxed patches in which some are coarsened instead.
#pragma once

#include <optional>
#include <vector>

#include "features/angles/patch_mesh.h"

namespace isoshell {

/// The mesh of `relaxed` without the patches that are to be coarse, and these coarsened from the fine mesh, to as many
/// vertices as are left of those asked for, and evened out. Curves that they share with relaxed patches have the seeds
/// of these. None where a vertex between such seeds cannot go, or coarse triangles beside such seeds meet relaxed ones:
/// then the patches beside its curve, or of these, are to be coarse, too. Coarse triangles meet others only where the
/// fine ones met each other. Result: the same for every number of threads. In host memory. Cost: as coarsen and
/// even_out, of the coarse patches.
std::optional<PatchMesh> coarsen_patches(const CutSurface& cut, const PatchMesh& relaxed, std::vector<char>& is_coarse,
                                         const JoinOptions& options, const Context& context);

}  // namespace isoshell
