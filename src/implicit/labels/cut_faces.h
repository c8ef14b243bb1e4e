// The faces of walls as triangles.
#pragma once

#include <vector>

#include "implicit/labels/label_walls.h"
#include "isoshell/advanced/lattice_surface.h"

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

/// Triangles, and the face that each is of.
struct CutFaces {
  std::vector<TriangleIndices> triangles;
  std::vector<uint32_t> face;
};
CutFaces cut_faces(const std::vector<std::array<uint32_t, 4>>& faces, const std::vector<PointQ8>& position);

}  // namespace isoshell
