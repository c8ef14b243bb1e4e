// The part of a surface that has points near it.
#pragma once

#include "implicit/points/point_support.h"

namespace isoshell {

/// Cuts off what is twice as far from points that look its way as these are from one another, and sooner where they
/// look another way, and crumbs that this leaves; triangles are cut where that is so, and have a border there. Cost: a
/// search for points near each vertex. Throws: nothing_to_mesh where nothing is left.
void trim_to_points(const PointsOfSurface& of, TriangleSoup& soup);

}  // namespace isoshell
