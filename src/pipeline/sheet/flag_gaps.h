// Which vertices of a result that follows the sheet lie in gaps of the input.
#pragma once

#include "pipeline/grid/prepared_surface.h"

namespace isoshell {

/// Per vertex of the mesh `at` has one of the sheet's. Where all walls were grown, vertices lie off the surface
/// everywhere, and none is flagged.
void flag_gaps(const PreparedSurface& p, View<const uint32_t> at, TriangleMesh& mesh, GapReport& report);

}  // namespace isoshell
