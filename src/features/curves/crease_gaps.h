// Creases that are interrupted.
#pragma once

#include "features/curves/edge_chains.h"

namespace isoshell {

/// The inner edges that lead on from where creases end freely, within 60 degrees of their direction, to the nearest
/// other curve, if that is at most `reach_world` away; edges that do not turn count twice. Ascending. A mesh whose
/// edges are that long could not show the gap, and a patch that is cut halfway would be one with the patch behind the
/// gap. `turns`: per edge, 1 - the cosine. Cost: the chains, and a search among the edges in reach of each end, at
/// most a few thousand, on all threads.
std::vector<uint32_t> edges_across_gaps(const FeatureMesh& mesh, const MeshEdges& edges, View<const double> turns,
                                        const std::vector<CurveEdge>& curve_edges, double reach_world);

}  // namespace isoshell
