// Which edges are creases.
#pragma once

#include "features/curves/edge_chains.h"
#include "features/curves/find_curves.h"

namespace isoshell {

/// Border and non-manifold edges.
std::vector<CurveEdge> find_fixed_curve_edges(const MeshEdges& edges);

/// And the inner edges that turn by the threshold or more.
std::vector<CurveEdge> with_creases_above(const FeatureMesh& mesh, const MeshEdges& edges,
                                          const std::vector<CurveEdge>& fixed, double degrees);

/// And these inner edges, ascending.
std::vector<CurveEdge> with_creases_at(const FeatureMesh& mesh, const MeshEdges& edges,
                                       const std::vector<CurveEdge>& fixed, const std::vector<uint32_t>& creases);

/// And the creases between surfaces that are smooth beside them, by filtered normals.
std::vector<CurveEdge> with_creases_beside_smooth(const FeatureMesh& mesh, const MeshEdges& edges,
                                                  const std::vector<CurveEdge>& fixed, const CurveOptions& options,
                                                  CreaseReport& report);

}  // namespace isoshell
