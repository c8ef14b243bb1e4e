// Patches of which some could not be relaxed.
#pragma once

#include <optional>
#include <vector>

#include "features/angles/patch_mesh.h"
#include "pipeline/patches/mesh_patches.h"

namespace isoshell {

/// The joined mesh of relaxed patches, in which those that are wrong are coarsened instead (see coarsen_patches.h), and
/// those that these come to meet. Afterwards `is_wrong` tells which were. None where they hold more than half of the
/// surface, or to coarsen them, once for each time that there are more, takes as much as to coarsen all, or a region of
/// coarse walls alone is inside out. In host memory. Cost: that of coarsening all at most, and a mesh of the relaxed
/// ones.
std::optional<JoinedPatches> mend_patches(const CutSurface& cut, const SeededMesh& made, std::vector<char>& is_wrong,
                                          const JoinOptions& options, Context& context);

/// The same of a surface that is no region's, or where that gives no mesh all patches coarsened: every curve stays, and
/// triangles meet where those of the input do, if anywhere. A warning says how many patches are coarse. None where many
/// fine triangles meet each other, where so few vertices cannot hold the curves, and where the memory limit does not
/// allow it.
std::optional<JoinedPatches> simplify_instead(const PreparedSurface& p, const CutSurface& cut, const SeededMesh& made,
                                              WrongPatches wrong, const PatchOptions& options, RemeshReport& report,
                                              Context& context);

}  // namespace isoshell
