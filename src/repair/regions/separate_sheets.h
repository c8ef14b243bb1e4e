// Edges of four faces as edges of two sheets.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "isoshell/advanced/lattice.h"

namespace isoshell::repair {

/// Where an edge has more than two faces, which bound solid behind them, those with solid between them go on as one
/// sheet: vertices and edges that sheets share there have a copy for each, moved by gap_world into its solid. Result:
/// the number of such edges. `source`: per face; those that are divided at the middle of such an edge follow at the
/// end. Decides without error. Cost: a sort of the edges.
int64_t separate_sheets(double gap_world, std::vector<WorldPoint>& point, std::vector<std::array<uint32_t, 3>>& face,
                        std::vector<uint32_t>& source);

}  // namespace isoshell::repair
