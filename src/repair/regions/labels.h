// Which part each cell of space belongs to.
#pragma once

#include <cstdint>
#include <vector>

#include "repair/regions/cells.h"
#include "repair/regions/chains.h"

namespace isoshell::repair {

/// Space that two closed parts lay claim to.
struct PartsOverlap {
  uint32_t keeper, other;
  double volume_world;
};

constexpr uint32_t kNoPart = 0xffffffff;

struct CellParts {
  std::vector<uint32_t> of_cell;       ///< kNoPart: none
  std::vector<double> volume_world;    ///< per part, of all cells that it is inside of, whichever part keeps them
  std::vector<PartsOverlap> overlaps;  ///< of parts of which none lies in the other; ascending by keeper and other
};

/// A cell belongs to the first part that it is inside of, that whose faces wind around it, of those in which no other
/// of them lies: parts that lie in larger ones, up to a hundredth of their volume, keep their space. A part that looks
/// inward is the hollow of the smallest part around it when `have_hollows`, and of no other is turned. Cost: a walk
/// over the cells, with the parts that each is inside of.
CellParts find_parts_of_cells(const Walls& walls, const Cells& cells, const Chains& chains, bool have_hollows);

}  // namespace isoshell::repair
