// The unit of what is said of vertices from frame to frame.
#pragma once

#include "geometry/world_vector.h"
#include "isoshell/triangle_mesh.h"

namespace isoshell {

/// Over the triangles' sides; 0 without triangles.
inline double mean_edge_length(const TriangleMesh& mesh) {
  double sum = 0;
  for (const std::array<uint32_t, 3>& t : mesh.triangles)
    for (int c = 0; c < 3; ++c) sum += length(mesh.vertices[t[size_t((c + 1) % 3)]] - mesh.vertices[t[size_t(c)]]);
  return mesh.triangles.empty() ? 0 : sum / double(3 * mesh.triangles.size());
}

}  // namespace isoshell
