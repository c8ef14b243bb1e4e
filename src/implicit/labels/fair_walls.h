// Labels say in which voxel a wall runs, not where in it: vertices of walls move until these are smooth.
#pragma once

#include <vector>

#include "implicit/labels/cut_faces.h"
#include "implicit/labels/label_walls.h"
#include "isoshell/backend.h"

namespace isoshell {

/// Constrained elastic nets (Gibson 1998, and Frisken 2022 for several labels) that bend as little as they can (see
/// ElasticNet): in each of a fixed number of steps vertices go down the slope of the bending energy, which is none on
/// straight walls, and are held near to where they were. Curves first go where the walls that meet there lead them,
/// and then get straight. What volumes of regions are still wrong by is mended by offsets of walls (see VolumeKeeper).
/// No vertex goes farther than `smoothing_vox` along an axis, and a quarter more on curves. Where triangles then
/// intersect, vertices go back to where a short first step had parted the walls. Result: per vertex its place in 1/256
/// voxel, for any number of threads. Cost: O(walls) a step, and a search for intersections (see crossing_pairs). Tells
/// the progress of "read". Throws: interrupted.
std::vector<PointQ8> fair_walls(const LabelWalls& walls, double smoothing_vox, const Context& context);

}  // namespace isoshell
