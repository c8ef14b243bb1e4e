// Where a mesh intersects itself.
#pragma once

#include <vector>

#include "isoshell/advanced/stages.h"

namespace isoshell {

/// The corners of triangles that intersect others, exactly tested: by x, y and z, each position once. `joined`: of the
/// first vertices the one that each is a copy of (see FixedSeeds). In host memory. Cost: as crossing_pairs.
std::vector<PointQ8> crossing_corners(const DualMesh& mesh, View<const uint32_t> joined);

}  // namespace isoshell
