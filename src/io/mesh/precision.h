// How precise the positions of a file have to be.
#pragma once

#include "isoshell/triangle_mesh.h"

namespace isoshell {

/// True when single precision would move a vertex by more than a thousandth of the shortest edge.
bool needs_double(const TriangleMesh& mesh);

}  // namespace isoshell
