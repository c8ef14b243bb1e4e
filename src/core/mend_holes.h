// Loops of edges with one face, and faces that close those that are holes.
#pragma once

#include "core/mend_patches.h"

namespace isoshell::mending {

struct Cap {
  std::vector<uint32_t> loop;  ///< half-edges of the mesh; each begins where the one before ends
  std::vector<Corners> face;   ///< oriented like the faces around
};
/// Closes holes when that is asked for, and counts the loops that stay open. Faces agree in their patches already. Caps
/// are in the order of their smallest half-edges.
std::vector<Cap> cap_holes(const MendMesh& mesh, const MendOptions& options, MendReport& report);

}  // namespace isoshell::mending
