// Triangulations of least area of a loop in space.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "isoshell/advanced/lattice.h"

namespace isoshell::repair {

/// Positions in the loop, each triangle in the loop's direction.
using LoopTriangle = std::array<uint32_t, 3>;

/// Triangulation of least area of the polygon, the first in order among equals; loops of more than 128 corners are cut
/// at their shortest chords before. Corners that `may_join` forbids are not joined; loop neighbours always are. Empty
/// when there is no such triangulation. Cost: n^3 steps up to 128 corners, then n^2 a cut, of
/// which the starts are at most 1024 corners.
std::vector<LoopTriangle> cap_loop(const std::vector<WorldPoint>& corner,
                                   const std::function<bool(uint32_t, uint32_t)>& may_join);

}  // namespace isoshell::repair
