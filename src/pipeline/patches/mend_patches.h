// Patches of which some could not be relaxed.
#pragma once

#include <optional>
#include <vector>

#include "features/angles/patch_mesh.h"

namespace isoshell {

/// The joined mesh of relaxed patches, in which those that are wrong are coarsened instead (see coarsen_patches.h), and
/// those that these come to meet. Afterwards `is_wrong` tells which were. None where they hold more than half of the
/// surface, or to coarsen them, once for each time that there are more, takes as much as to coarsen all, or a region of
/// coarse walls alone is inside out. In host memory. Cost: that of coarsening all at most, and a mesh of the relaxed
/// ones.
std::optional<JoinedPatches> mend_patches(const CutSurface& cut, const SeededMesh& made, std::vector<char>& is_wrong,
                                          const JoinOptions& options, Context& context);

}  // namespace isoshell
