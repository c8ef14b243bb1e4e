// Faces that close loops which are holes.
#pragma once

#include "repair/repair_loops.h"
#include "repair/repair_patches.h"

namespace isoshell::repair {

struct Cap {
  Loop loop;                  ///< what it closes; of a tube both its ends, one after the other
  std::vector<Corners> face;  ///< oriented like the faces around
};
/// Closes holes when that is asked for, all but those that tubes join, and counts the loops that stay open. Faces agree
/// in their patches already. Tubes come first, then caps in the order of their smallest half-edges.
std::vector<Cap> cap_holes(const RepairMesh& mesh, std::vector<Cap> tubes, const RepairOptions& options,
                           RepairReport& report);

}  // namespace isoshell::repair
