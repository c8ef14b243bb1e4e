// Normals of the sides that points of sharp bodies lie on: beside a crease, neighbours from both sides blend them.
#pragma once

#include "implicit/points/point_normals.h"

namespace isoshell {

/// A normal for each point, outward: where its neighbours do not lie on a plane, that of a neighbour whose do, if its
/// plane passes the point. Empty where the points are not of a sharp body, whose neighbourhoods are flat but for a few
/// that are bent by much; they may be off by a tenth of their spacing. Cost: a sample of the points, and of sharp
/// bodies a search for the neighbours of all.
std::vector<WorldPoint> find_flat_normals(const OrientedPoints& points, const PointTree& tree);

}  // namespace isoshell
