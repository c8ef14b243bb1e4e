// Where values say it the walls between labels run through places between the centres of voxels.
#pragma once

#include <vector>

#include "implicit/labels/label_walls.h"
#include "isoshell/backend.h"

namespace isoshell {

/// That of a face of voxels. Where a volume has none, as of two voxels that had one label until islands were absorbed,
/// it is in the middle. Cost: a search.
WallCrossing crossing_of(const LabelVolume& volume, int64_t face);

/// Every vertex goes where the planes of the crossings around it meet: their least squares point, as dual contouring
/// has it (Ju et al. 2002), so that walls have the creases that their crossings show, and curves lie where several
/// walls meet. It stays between the centres of the voxels around it, and goes back where triangles would intersect (see
/// part_crossing). Result: per vertex its place in 1/256 voxel, for any number of threads. Cost: O(walls), and a search
/// for intersections. Tells the progress of "read". Throws: interrupted.
std::vector<PointQ8> place_walls(const LabelWalls& walls, const LabelVolume& volume, const Context& context);

}  // namespace isoshell
