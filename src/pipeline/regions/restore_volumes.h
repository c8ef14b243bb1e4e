// The triangles of a result cut off what is curved; its regions have the volumes of their voxels all the same.
#pragma once

#include "features/angles/patch_mesh.h"
#include "pipeline/regions/region_walls.h"

namespace isoshell {

/// Offsets the walls of a result, so that regions have the volumes that they had before (see pressures_of_regions), by
/// no more than a small part of the edges there. Walls at the sides of a volume stay on them. A vertex goes nowhere
/// where triangles would come to intersect or turn over, or have a smaller angle where that is below 30 degrees.
/// Result: the same for any number of threads. Cost: O(mesh), and some searches for intersections. Throws: interrupted.
void restore_volumes(const CutSurface& cut, const RegionWalls& walls, JoinedPatches& joined, Context& context);

}  // namespace isoshell
