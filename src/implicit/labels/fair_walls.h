// Labels say in which voxel a wall runs, not where in it: vertices of walls move until these are smooth.
#pragma once

#include <vector>

#include "implicit/labels/cut_faces.h"
#include "implicit/labels/label_walls.h"
#include "isoshell/backend.h"

namespace isoshell {

/// Constrained elastic nets (Gibson 1998, and Frisken 2022 for several labels; see ElasticNet): in each of a fixed
/// number of steps vertices go most of the way to the mean of their neighbours. Steps flatten noise, and take from the
/// coarse shape, too: what they took is smoothed by as many steps and given back (twicing, Tukey 1977), which
/// halves the error where walls are curved. What volumes of regions are still wrong by is mended by offsets of
/// walls (see VolumeKeeper). Where triangles then intersect, vertices go back to where the first, shorter step had
/// parted the walls. Result: per vertex its place in 1/256 voxel, for any number of threads. Cost: O(walls) a step, and
/// a search for intersections (see crossing_pairs). Tells the progress of "read". Throws: interrupted.
std::vector<PointQ8> fair_walls(const LabelWalls& walls, const Context& context);

}  // namespace isoshell
