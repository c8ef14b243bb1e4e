// On which side points lie, exactly, for coordinates of the world.
#pragma once

#include "isoshell/advanced/lattice.h"

namespace isoshell {

/// 1, 0 or -1 as the volume of (a, b, c, d) is: positive when d lies on the side that (b - a) x (c - a) points to.
/// Exact unless products of three differences leave the range of doubles. Cost: a few operations where rounding cannot
/// change the sign, up to some microseconds where it might.
int side_of_plane(const WorldPoint& a, const WorldPoint& b, const WorldPoint& c, const WorldPoint& d);

struct WorldPoint2 {
  double x, y;
};
/// 1, 0 or -1 as the path from a over b to c turns left, goes on or turns right. Exact in the same way.
int turn(const WorldPoint2& a, const WorldPoint2& b, const WorldPoint2& c);

}  // namespace isoshell
