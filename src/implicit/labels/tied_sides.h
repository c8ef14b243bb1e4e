// Vertices of walls that are one in space, as a volume goes on with its other side.
#pragma once

#include <array>

#include "implicit/labels/label_walls.h"

namespace isoshell {

/// Finds walls.tied. Labels of opposite sides are the same along these axes. A thin voxel beside one side is one beside
/// the other. Cost: a sort of the faces at such sides.
void tie_sides(const std::array<bool, 3>& is_periodic, LabelWalls& walls);

}  // namespace isoshell
