// Parts whose own faces meet, as others write them that touch themselves.
#pragma once

#include "pipeline/grid/prepared_surface.h"
#include "pipeline/sheet/crease_search.h"

namespace isoshell {

/// Cuts the mesh along itself where its own faces touch or pass through others, and keeps what they bound together: its
/// triangles meet nowhere then, unless rounding to the lattice makes them: p.own_faces_meet. Its creases are to be
/// found again. Where nothing meets, or that bounds no closed surface, or a vertex has more than 1024 triangles, it
/// stays. The surface is closed and oriented. Cost: a search for faces that meet, one more where some do.
void unite_own_faces(SearchedSurface& searched, PreparedSurface& p, RemeshReport& report, Context& context);

}  // namespace isoshell
