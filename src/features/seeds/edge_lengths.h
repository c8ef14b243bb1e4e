// Edge lengths that vary over a fine mesh: shorter where it bends and beside curves that turn or run close.
#pragma once

#include "features/seeds/facing_curves.h"

namespace isoshell {

/// How many vertices the lengths of a mesh ask for. Triangles of that size fill the area; a border has more vertices
/// than the area beside it, half of one an edge, and where three sheets meet there are as many fewer.
double vertices_of_lengths(const FineMesh& mesh);

struct LengthOptions {
  int64_t vertices = 0;       ///< above 0: lengths are in such a proportion that they ask for so many; 0: as they are
  double growth = 0.2;        ///< most that a length grows, over the way
  bool as_requested = false;  ///< whatever the surface is like
  bool is_rough = false;      ///< turns, of curves too, are no bends: it is made of voxels
};

/// Sets the lengths of a mesh, which has those asked for, equal ones or others, less where bends and close curves limit
/// them: the shortest are a quarter of what is asked for, and a sixteenth of the longest. Leaves equal ones as they are
/// where nothing limits them. Cost: a sort of the edges, some rounds over them.
void vary_edge_lengths(FineMesh& mesh, const VertexGraph& graph, const std::vector<FacingVertices>& facing,
                       const LengthOptions& options);

}  // namespace isoshell
