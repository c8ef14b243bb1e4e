// Regions as small as their edges may come out inside out.
#pragma once

#include <vector>

#include "features/cutting/cut_surface.h"
#include "isoshell/advanced/stages.h"

namespace isoshell {

/// The vertices of the walls of regions whose volume is not above 0, though the surface's is; ascending. `patch`: per
/// triangle. In host memory. Cost: O(triangles), and where there are any O(fine triangles).
std::vector<uint32_t> find_inverted_regions(const CutSurface& cut, const DualMesh& mesh,
                                            const std::vector<uint32_t>& patch);

}  // namespace isoshell
