// Where a mesh intersects itself.
#pragma once

#include <array>
#include <vector>

#include "isoshell/advanced/stages.h"

namespace isoshell {

/// By x, y and z, each once.
void sort_points(std::vector<PointQ8>& places);

/// The corners of the triangles of some pairs: by x, y and z, each position once.
std::vector<PointQ8> corners_of(const DualMesh& mesh, const std::vector<std::array<uint32_t, 2>>& pairs);

/// The corners of triangles that intersect others, exactly tested: by x, y and z, each position once. `joined`: of the
/// first vertices the one that each is a copy of (see FixedSeeds). In host memory. Cost: as crossing_pairs.
std::vector<PointQ8> crossing_corners(const DualMesh& mesh, View<const uint32_t> joined);

}  // namespace isoshell
