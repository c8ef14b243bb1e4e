// Patches of a mesh: what edges of exactly two faces connect. Small ones that only hang on the rest are dropped, and
// the faces of each are made to agree.
#pragma once

#include "core/mend_mesh.h"
#include "isoshell/mend.h"

namespace isoshell::mending {

struct Patches {
  std::vector<uint32_t> of;  ///< per face; kNoFace for dead ones. Numbered by their smallest face
  uint32_t count = 0;
};
Patches find_patches(const MendMesh& mesh);
std::vector<double> patch_areas(const MendMesh& mesh, const Patches& patches);

double live_area(const MendMesh& mesh);

/// Drops fins (see mend.h), the smallest first, until no patch is one. A T-junction counts as closed.
void drop_fins(MendMesh& mesh, MendReport& report);

/// Turns faces so that the faces of every patch agree as far as they can; the way round that more of them had stays.
void orient_patches(MendMesh& mesh);

/// Drops islands (see mend.h). Patches of two faces that join count together.
void drop_islands(MendMesh& mesh, const std::vector<std::array<uint32_t, 2>>& joins, MendReport& report);

}  // namespace isoshell::mending
