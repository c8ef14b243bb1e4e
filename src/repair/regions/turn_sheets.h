// Faces of sheets that look to one side.
#pragma once

#include "isoshell/surface_source.h"

namespace isoshell::repair {

/// Turns faces of sheets so that two of them that share an edge with no other look to the same side, that of the first
/// of all that are connected so. A sheet with one side alone keeps some that do not. Cost: a sort of the edges.
void turn_sheets(TriangleSoup& walls);

}  // namespace isoshell::repair
