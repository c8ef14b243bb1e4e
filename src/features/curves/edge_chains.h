// Edges that belong to curves, put together to chains.
#pragma once

#include "features/mesh/mesh_edges.h"

namespace isoshell {

struct CurveEdge {
  uint32_t edge;
  CurveKind kind;
  double turn;  ///< 1 - the cosine of the turn at a crease; 0 at other kinds
};

/// Edges of one kind, one after the other, between vertices with another number of curve edges than two, or edges of
/// two kinds: its ends. A ring has no end.
struct EdgeChain {
  CurveKind kind;
  bool is_ring;
  double turn;                     ///< mean of its edges
  std::vector<uint32_t> edge;      ///< along the chain
  std::vector<uint32_t> vertex;    ///< one more than edges; a ring's last is its first
  std::array<uint32_t, 2> degree;  ///< curve edges at the first and at the last vertex
};

/// Result: chains in the order of their smallest edge. Those between ends run from the smaller vertex, or from the
/// smaller edge where both ends are one vertex; rings from their smallest vertex along its smaller edge. `curve_edges`
/// are ascending and unique. Cost: a sort of them.
std::vector<EdgeChain> find_chains(const MeshEdges& edges, const std::vector<CurveEdge>& curve_edges);

double length_of(const FeatureMesh& mesh, const EdgeChain& chain);

}  // namespace isoshell
