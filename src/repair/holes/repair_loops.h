// Loops of edges with one face: boundaries, followed around vertices where several meet.
#pragma once

#include <vector>

#include "repair/holes/repair_mesh.h"

namespace isoshell::repair {

/// Half-edges; each begins where the one before ends.
using Loop = std::vector<uint32_t>;

/// In the order of their smallest half-edges, which come first. Faces agree in their patches already.
std::vector<Loop> closed_loops(const RepairMesh& mesh);

}  // namespace isoshell::repair
