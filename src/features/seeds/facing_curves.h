// Curves that run side by side, with a strip of the surface between them.
#pragma once

#include <vector>

#include "features/mesh/vertex_graph.h"

namespace isoshell {

/// Two vertices of paths with a strip between them, whose sides meet in an edge of the fine mesh.
struct FacingVertices {
  uint32_t on_path[2];  ///< each the nearest to the vertex in the middle that is on its side
  uint32_t middle[2];   ///< ends of an edge of the fine mesh
  double gap;           ///< from one to the path of the other, the lesser way
};

/// Every edge of the fine mesh between two vertices that are within `reach` of paths, but nearest to different points
/// of them, which face each other: they are much nearer than the way along the paths. Ascending by middle. Lengths are
/// in 1/256 voxel. Cost: a search of what is within reach of paths.
std::vector<FacingVertices> find_facing_vertices(const FineMesh& mesh, const VertexGraph& graph, double reach);

}  // namespace isoshell
