// Normals of the vertices of a mesh.
#pragma once

#include <array>
#include <vector>

#include "geometry/world_vector.h"

namespace isoshell {

/// Per point the sum of the normals of its triangles, by their area: of no certain length.
inline std::vector<WorldPoint> outward_normals(const std::vector<WorldPoint>& points,
                                               const std::vector<std::array<uint32_t, 3>>& triangles) {
  std::vector<WorldPoint> normals(points.size(), WorldPoint{0, 0, 0});
  for (const auto& t : triangles) {
    const WorldPoint area = doubled_area(points[t[0]], points[t[1]], points[t[2]]);
    for (const uint32_t v : t) normals[v] = normals[v] + area;
  }
  return normals;
}

}  // namespace isoshell
