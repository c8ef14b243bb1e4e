// Whether walls are too near to one another for the edges that they are to have.
#pragma once

#include <cstdint>

#include "features/cutting/cut_surface.h"

namespace isoshell {

/// The part of the walls, of samples of their area, that bends within an edge and has another wall within half of one:
/// triangles of so many vertices would intersect there. Cost: a tree of the triangles' boxes, and two looks down it for
/// each sample, of which there are some ten thousand at most.
double share_of_near_walls(const CutSurface& cut, int64_t vertices);

}  // namespace isoshell
