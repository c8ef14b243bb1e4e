// Patches as small as their edges.
#pragma once

#include <vector>

#include "features/cutting/cut_surface.h"
#include "isoshell/advanced/stages.h"

namespace isoshell {

/// Triangulates those of some patches that have one border and few free seeds anew: with one vertex inside, the one of
/// the surface that is farthest from the seeds of the border, in the middle of all triangles. So two patches with the
/// same border have different faces. Result: which patches that was done to. In host memory. Cost: O(surface).
std::vector<char> triangulate_as_fans(const CutSurface& cut, const std::vector<char>& is_chosen, SeededMesh& made);

}  // namespace isoshell
