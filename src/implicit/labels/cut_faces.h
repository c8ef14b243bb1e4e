// The faces of walls as triangles.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "isoshell/advanced/lattice_surface.h"
#include "isoshell/advanced/voxel_set.h"

namespace isoshell {

/// Whether a face of four corners is cut from its first one to its third: along the shorter diagonal, and of two that
/// are as long along that from the first corner.
inline bool is_cut_from_first(const std::array<uint32_t, 4>& face, const std::vector<PointQ8>& position) {
  const auto distance_sq = [&](uint32_t a, uint32_t b) {
    const PointQ8 &p = position[a], &q = position[b];
    const int64_t x = p.x - q.x, y = p.y - q.y, z = p.z - q.z;
    return x * x + y * y + z * z;
  };
  return distance_sq(face[0], face[2]) <= distance_sq(face[1], face[3]);
}

/// Calls visit(triangle) for the one or two triangles of a face.
template <class Visit>
void each_triangle(const std::array<uint32_t, 4>& face, const std::vector<PointQ8>& position, const Visit& visit) {
  const auto& [a, b, c, d] = face;
  if (d == kNone) {
    visit(TriangleIndices{a, b, c});
  } else if (is_cut_from_first(face, position)) {
    visit(TriangleIndices{a, b, c});
    visit(TriangleIndices{a, c, d});
  } else {
    visit(TriangleIndices{a, b, d});
    visit(TriangleIndices{b, c, d});
  }
}

/// All of them, face by face.
std::vector<TriangleIndices> triangles_of_faces(const std::vector<std::array<uint32_t, 4>>& faces,
                                                const std::vector<PointQ8>& position);

}  // namespace isoshell
