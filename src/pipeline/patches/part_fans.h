// Parts of a result that touch in a vertex only.
#pragma once

#include "isoshell/triangle_mesh.h"

namespace isoshell {

/// A vertex for every fan of triangles: parts that touch in a vertex only, and borders that pass one twice, part there,
/// by a step of the lattice into the fan, as many files know vertices by position. Triangles begin at their smallest
/// vertex then, and are sorted; the mesh's features go along.
void part_fans(TriangleMesh& mesh, double step_world);

}  // namespace isoshell
