// Cells that are too thin to be meshed, as walls leave them that nearly lie on each other.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "repair/regions/cells.h"

namespace isoshell::repair {

/// Those that belong to what is beside them now.
struct JoinedCells {
  int64_t count = 0;
  std::optional<WorldPoint> first;  ///< a corner of one
};

/// A cell that is thinner than that, twice its volume over the area of its walls, gets the label with which it shares
/// most of these. No label goes whose cells are all thin, unless each cell has its own. `label`: per cell, that of the
/// one outside first. Cost: a walk over the walls for each layer of thin cells.
JoinedCells join_thin_cells(const Walls& walls, const Cells& cells, double thin_world, bool each_has_its_own,
                            std::vector<int32_t>& label);

}  // namespace isoshell::repair
