// T-junctions: edges beside which the boundary on their other side is divided.
#pragma once

#include <vector>

#include "repair/holes/repair_mesh.h"

namespace isoshell::repair {

/// Edges of one face, or of two where a fin stands on them, beside which a boundary runs, over at least one more
/// vertex, from one end to the other, and the edges of those boundaries: a face without area between them would join
/// them. Ascending, once each.
std::vector<uint32_t> edges_at_junctions(const RepairMesh& mesh);

}  // namespace isoshell::repair
