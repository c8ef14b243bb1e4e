// Patches that begin with the vertices of the frame before.
#pragma once

#include "pipeline/patches/patches.h"

namespace isoshell {

/// The vertices of options.previous that are inside of patches, each in the patch that it lies on and that faces its
/// way, relaxed in few passes; curves have kept theirs where the surface was cut for that. Patches have as many as
/// before, as far as their size allows, and new ones in the middles of the longest edges; those with the shortest edges
/// go.
RelaxedSeeds relax_patches_from_previous(const CutSurface& cut, const PatchOptions& options, Context& context);

}  // namespace isoshell
