// The edges of a feature mesh: which triangles they have, and which edges a triangle has.
#pragma once

#include "features/mesh/feature_mesh.h"
#include "isoshell/advanced/buffer.h"

namespace isoshell {

/// What an edge is between, by its triangles alone.
enum class EdgeUse : uint8_t {
  inner,         ///< two triangles, which pass it in opposite directions
  border,        ///< one triangle
  non_manifold,  ///< three triangles or more, or two that pass it the same way
};

struct FeatureEdge {
  std::array<uint32_t, 2> end;   ///< vertices, the smaller first
  std::array<uint32_t, 2> face;  ///< its first two triangles; twice the same at a border
  EdgeUse use;
};

struct MeshEdges {
  Buffer<FeatureEdge> edges;                    ///< sorted by their ends
  Buffer<std::array<uint32_t, 3>> of_triangle;  ///< edge i runs from corner i to the next

  uint32_t count() const { return uint32_t(edges.size()); }
  bool is_inner(uint32_t edge) const { return edges[edge].use == EdgeUse::inner; }
  /// The triangle on the other side of an inner edge.
  uint32_t across(uint32_t edge, uint32_t face) const {
    const auto& f = edges[edge].face;
    return f[0] == face ? f[1] : f[0];
  }
};

/// Throws: usage where half-edges cannot be numbered in 32 bits. Cost: a sort of the half-edges.
MeshEdges find_mesh_edges(const FeatureMesh& mesh);

/// Per triangle the smallest triangle that it is connected to by edges.
std::vector<uint32_t> components_of(const FeatureMesh& mesh, const MeshEdges& edges);

}  // namespace isoshell
