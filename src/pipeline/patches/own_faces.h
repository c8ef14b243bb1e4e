// Parts whose own faces meet, as others write them that touch themselves.
#pragma once

#include "pipeline/sheet/crease_search.h"

namespace isoshell {

/// Cuts the mesh along itself where its own faces touch or pass through others, or share edges, and keeps what they
/// bound together, without slivers. Its creases have been found, and are to be found again. Sets p.own_faces_meet where
/// these faces meet all the same once they are rounded to the lattice. The mesh stays as it is where nothing meets,
/// where that bounds no closed surface, and where a vertex has more than 1024 triangles. The surface is closed and
/// oriented. Cost: a search for faces that meet, and where some do the union, and another search.
void unite_own_faces(SearchedSurface& searched, PreparedSurface& p, Run& run);

}  // namespace isoshell
