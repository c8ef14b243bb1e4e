// Walls of regions of voxels that would leave a curve nearly side by side, which meshers of volumes refuse, are opened.
#pragma once

#include "features/angles/patch_mesh.h"
#include "pipeline/regions/region_walls.h"

namespace isoshell {

/// Where two triangles of a result have less than 10 degrees between them at their common edge, a corner of one of them
/// goes away from the other one, by no more than a part of the edge. A corner goes nowhere where triangles would come
/// to intersect or turn over, or have a smaller angle where that is below 30 degrees, or the least angle between
/// triangles around it would not grow; those at the sides of a volume stay. What cannot be opened stays as it is.
/// Result: the same for any number of threads. Cost: O(mesh), and a look around each such edge.
void open_wedges(const RegionWalls& walls, const CutSurface& cut, JoinedPatches& joined, Context& context);

}  // namespace isoshell
