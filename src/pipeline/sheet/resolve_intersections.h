// What is done where triangles of the result intersect although their vertices went back to where they began.
#pragma once

#include "pipeline/grid/prepared_surface.h"

namespace isoshell {

/// The mesh is made once more, from its own seeds: on a sheet without intersections, with seeds put in where the dual
/// intersects, and as many taken out elsewhere; then once more without flips, which are what cannot be undone. Of all
/// these the mesh with the fewest intersections counts, the first among equals; `mesh` and the report become its
/// own. Ids are kept where that is asked for.
void resolve_intersections(const PreparedSurface& prepared, const OptimizeOptions& options, bool keep_ids,
                           SeededMesh& mesh, RemeshReport& report, Context& context);

}  // namespace isoshell
