// Flat faces with holes that are missing whole.
#pragma once

#include "repair/holes/repair_holes.h"

namespace isoshell::repair {

/// Faces between loops of one plane: an outer one, whose surface lies behind the face, and those inside of it that run
/// the other way round, as pockets do, one of them at least of a surface that hangs on nothing else. A rim alone may be
/// that of a box that is open; what floats in it, ends in its plane and looks into itself shows that there was a face.
/// The faces of every patch agree already. Cost: the square of the number of loops in planes, of which there are at
/// most 2000, and a triangulation each.
std::vector<Cap> find_missing_faces(const RepairMesh& mesh, const std::vector<Loop>& loops);

}  // namespace isoshell::repair
