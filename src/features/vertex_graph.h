// The vertices of a fine mesh that its edges join.
#pragma once

#include "features/refine_mesh.h"

namespace isoshell {

struct VertexGraph {
  std::vector<int64_t> first;       ///< per vertex, and one more: offsets into neighbour
  std::vector<uint32_t> neighbour;  ///< ascending per vertex
};

/// Cost: a sort of the edges.
VertexGraph find_vertex_graph(const MeshTriangles& triangles, size_t vertices);

}  // namespace isoshell
