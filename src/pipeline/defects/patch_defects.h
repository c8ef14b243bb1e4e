// Where the triangles of patches are no surface.
#pragma once

#include <vector>

#include "isoshell/advanced/stages.h"

namespace isoshell {

/// The vertices of a dual whose triangles are no single fan, that are fixed and not on its border or on it and not
/// fixed, or that have an edge that is there twice, in a patch or once patches are joined; ascending. In host memory.
/// Cost: a sort of the half-edges.
std::vector<uint32_t> find_patch_defects(const SeededMesh& made);

}  // namespace isoshell
