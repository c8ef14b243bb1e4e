// A fine mesh on the lattice, cut open along its paths.
#pragma once

#include <memory>

#include "features/cutting/cut_surface.h"

namespace isoshell {

/// Snaps the vertices, gives every fan of triangles between paths a vertex of its own, and every component of triangles
/// becomes a patch. Curve c is path c. Leaves open for how many seeds it is cut. Cost: sorts of the fine edges and
/// vertices. Throws: usage where a border or non-manifold edge is on no path. `twins`: those between paths; empty:
/// not known.
CutSurface cut_fine_mesh(std::shared_ptr<const FineMesh> fine, const LatticeFrame& frame, Context& context,
                         MeshTwins twins = {});

/// Lists the copies of so many places from the place of every vertex.
void list_copies(size_t places, CutSurface& cut);

}  // namespace isoshell
