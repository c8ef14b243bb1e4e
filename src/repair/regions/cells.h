// The cells that walls cut space into.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "isoshell/backend.h"
#include "repair/regions/walls.h"

namespace isoshell::repair {

/// Cell 0 is all that lies outside. The others are numbered by the smallest walls around them, and of two that share
/// theirs the one behind it comes first, so that the numbers do not depend on how faces of the input are numbered.
struct Cells {
  std::vector<std::array<uint32_t, 2>> of_wall;  ///< in front of it and behind it; the same of a sheet
  std::vector<double> volume_world;              ///< per cell; of the one outside 0

  size_t count() const { return volume_world.size(); }
};

/// Sides of walls are joined around edges, and surfaces that lie in a cell of another one by rays. Decides where walls
/// lie around edges without error, on their lattice: corners are up to half a step off it, which may turn two walls
/// that are nearly on each other. Throws: interrupted. Cost: a sort of the edges, and a ray from each connected
/// surface.
Cells find_cells(const Walls& walls, const Context& context);

}  // namespace isoshell::repair
