// Curves that turn to and fro, as the rims of scans and the edges of voxels do.
#pragma once

#include "features/mesh/curve_paths.h"

namespace isoshell {

/// Marks the borders, and edges of three faces or more, that turn much, but within four edge lengths mostly back again.
/// `edge_length` in 1/256 voxel.
void find_jagged_paths(const std::vector<WorldPoint>& position, double edge_length, std::vector<CurvePath>& paths);

}  // namespace isoshell
