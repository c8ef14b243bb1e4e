// Labels say in which voxel a wall runs, not where in it: vertices of walls move until these are smooth.
#pragma once

#include <vector>

#include "implicit/labels/label_walls.h"
#include "isoshell/advanced/lattice_surface.h"

namespace isoshell {

/// Constrained elastic nets (Gibson 1998, and Frisken 2022 for several labels): in each of a fixed number of steps
/// every vertex goes half of the way to the mean of its neighbours, and stays within half a voxel of its rest along
/// each axis. Neighbours of a vertex on curves, where edges have other than two faces, are those along the curves. All
/// sums are of integers: no order shows. Where triangles then intersect, vertices go back to where the first, shorter
/// step had parted the walls. Result: per vertex its place in 1/256 voxel. Cost: O(walls) a step, and a search for
/// intersections (see crossing_pairs).
std::vector<PointQ8> fair_walls(const LabelWalls& walls);

/// Triangles, and the face that each is of. Faces of four corners are cut along the shorter diagonal; of two that are
/// as long the one from the first corner.
struct CutFaces {
  std::vector<TriangleIndices> triangles;
  std::vector<uint32_t> face;
};
CutFaces cut_faces(const LabelWalls& walls, const std::vector<PointQ8>& position);

}  // namespace isoshell
