#pragma once

#include "isoshell/surface_source.h"

namespace isoshell {

/// Enclosed volume of a closed surface, positive where it faces outward.
inline double volume(const TriangleSoup& soup) {
  double six = 0;
  for (const auto& t : soup.triangles) {
    const WorldPoint &a = soup.vertices[t[0]], &b = soup.vertices[t[1]], &c = soup.vertices[t[2]];
    six += a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x);
  }
  return six / 6;
}

}  // namespace isoshell
