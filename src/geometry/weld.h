// Vertices of one position as one.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "isoshell/advanced/lattice.h"

namespace isoshell {

/// Positions, ascending and once each, and per vertex its place among them.
struct WeldedVertices {
  std::vector<WorldPoint> position;
  std::vector<uint32_t> place;
};

/// Of the vertices that triangles use; of one position the first one says how its zeros are signed. Cost: a sort.
WeldedVertices weld_vertices(const std::vector<WorldPoint>& vertices,
                             const std::vector<std::array<uint32_t, 3>>& triangles);

}  // namespace isoshell
