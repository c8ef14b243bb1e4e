// Vertices as glTF has them: with one value of every attribute each.
#pragma once

#include <vector>

#include "isoshell/triangle_mesh.h"

namespace isoshell {

/// Those of a mesh, split where their corners' values differ, in the order of the mesh's vertices.
struct GltfVertexSplit {
  std::vector<uint32_t> vertex;                    ///< per vertex that of the mesh
  std::vector<size_t> corner;                      ///< per vertex a corner with its values
  std::vector<std::array<uint32_t, 3>> triangles;  ///< in the order of the mesh's
};
GltfVertexSplit split_vertices(const TriangleMesh& mesh, const std::vector<const Attribute*>& of_corners);

}  // namespace isoshell
