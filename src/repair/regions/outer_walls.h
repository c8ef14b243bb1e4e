// The walls that bound solid.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "repair/regions/cells.h"
#include "repair/regions/walls.h"

namespace isoshell::repair {

/// Which cells are solid.
enum class SolidRule : uint8_t {
  winding,         ///< those that faces wind around more than 0 times in all
  seen_from_back,  ///< all but the outer one that some face looks away from
  enclosed         ///< all but the outer one
};

struct OuterWalls {
  std::vector<WorldPoint> point;
  std::vector<std::array<uint32_t, 3>> face;        ///< solid is behind it
  std::vector<uint32_t> source;                     ///< per face the smallest number of those on its wall
  std::vector<std::array<WorldPoint, 3>> touching;  ///< walls between parts that touch, which have solid on both sides
};

/// `have_closed_chains` where at every edge as many faces pass it one way as the other: their windings are known then.
bool have_closed_chains(const Walls& walls);

/// Cost: a walk over the cells.
OuterWalls find_outer_walls(const Walls& walls, const Cells& cells, SolidRule rule);

}  // namespace isoshell::repair
