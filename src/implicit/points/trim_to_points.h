// The part of a surface that has points near it.
#pragma once

#include "implicit/points/point_support.h"

namespace isoshell {

/// Cuts off what is farther from points that look its way than three times as far as these are from one another, and
/// pieces that are left of it with hardly any area; the triangles are cut where that is so, and have a border there.
/// Cost: a search for points near each vertex.
void trim_to_points(const PointsOfSurface& of, TriangleSoup& soup);

}  // namespace isoshell
