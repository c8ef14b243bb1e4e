// What points say about a surface near them: where it is drawn onto them, and which of its parts they support.
#pragma once

#include <vector>

#include "implicit/points/point_normals.h"
#include "isoshell/surface_source.h"

namespace isoshell {

/// Points and the closed surface of their indicator function, from voxels of `voxel_size`. A point tells only of a
/// surface that looks the way the point does: the other side of a thin wall has points of its own, or none.
struct PointsOfSurface {
  const OrientedPoints& points;
  const PointTree& tree;
  double voxel_size;
};

/// Leaves out components that hardly any point supports, and numbers the vertices that stay anew. Every point supports
/// the nearest vertex of the surface that looks its way. Hollows stay only where the file's own normals face them:
/// normals that were turned here all look away from what they enclose, and where they do not they are wrong.
void drop_unsupported(const PointsOfSurface& of, TriangleSoup& soup);

/// The part of the points, by area, that have vertices near them, whichever way both look.
double held_part(const PointsOfSurface& of, const TriangleSoup& soup);

/// 1 for vertices that have points near them, 0 for those that bridge.
std::vector<uint8_t> find_supported(const PointsOfSurface& of, const TriangleSoup& soup);

/// Moves vertices onto the points around them, less where that would fold the surface. Returns what find_supported
/// says of them before.
std::vector<uint8_t> pull_to_points(const PointsOfSurface& of, TriangleSoup& soup);

}  // namespace isoshell
