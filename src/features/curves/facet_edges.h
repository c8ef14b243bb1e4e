// Edges between flat facets that stand for a round surface, where facets are as wide as edges of the result are long.
#pragma once

#include <vector>

#include "features/curves/edge_chains.h"

namespace isoshell {

/// Edges that turn by 4 degrees or more, less than creases do, where both sides are flat for .85 h: on them the result
/// has the normals of its input, off them it would lie across. Only chains that are rings or run between curves count:
/// so cylinders and prisms have them, and round shapes of triangles have none. `normals` are those of the triangles,
/// `turns` per edge 1 - the cosine between them; `curve_edges` are ascending. Result: ascending, none of those. Cost: a
/// walk of .85 h from the edges that turn.
std::vector<uint32_t> find_facet_edges(const FeatureMesh& mesh, const MeshEdges& edges, View<const WorldPoint> normals,
                                       const std::vector<CurveEdge>& curve_edges, double edge_length_world);

}  // namespace isoshell
