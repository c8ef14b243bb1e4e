// Creases that are too small for the edges that the result aims at.
#pragma once

#include "features/curves/edge_chains.h"

namespace isoshell {

/// Result: the curve edges without
/// - creases that end freely, or where they began, and are shorter than 2 h; the shortest are dropped first;
/// - the weaker of two paths around a patch with less than 6 h of border, if it turns by less than 60 degrees: where a
///   crease runs through a row of triangles instead of along edges, both sides of some triangles turn by a part of it.
std::vector<CurveEdge> drop_small_creases(const FeatureMesh& mesh, const MeshEdges& edges,
                                          std::vector<CurveEdge> curve_edges, double edge_length_world);

/// Result: the curve edges without the creases of the least turn times length, so that all curves take at most so many
/// vertices at edges of the length h, if dropping creases can do that.
std::vector<CurveEdge> drop_least_creases(const FeatureMesh& mesh, const MeshEdges& edges,
                                          std::vector<CurveEdge> curve_edges, double edge_length_world,
                                          double most_vertices);

}  // namespace isoshell
