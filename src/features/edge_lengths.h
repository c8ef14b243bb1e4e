// Edge lengths that vary over a fine mesh: shorter where it bends and beside curves that turn or run close.
#pragma once

#include "features/facing_curves.h"

namespace isoshell {

/// How many vertices the lengths of a mesh ask for. Triangles of that size fill the area; a border has more vertices
/// than the area beside it, half of one an edge, and where three sheets meet there are as many fewer.
double vertices_of_lengths(const FineMesh& mesh);

/// Sets the lengths of a mesh that was cut at one for all, so that they ask for `vertices`: where nothing limits them
/// they are longest and equal. They grow by at most a fifth of the way, and the shortest are a quarter of the
/// longest. Leaves them as they are where nothing limits them. Cost: a sort of the edges, some rounds over them.
void vary_edge_lengths(FineMesh& mesh, const VertexGraph& graph, const std::vector<FacingVertices>& facing,
                       int64_t vertices);

}  // namespace isoshell
