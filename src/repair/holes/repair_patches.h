// Patches of a mesh: what edges of exactly two faces connect. Small ones that only hang on the rest are dropped, and
// the faces of each are made to agree.
#pragma once

#include "isoshell/repair.h"
#include "repair/holes/repair_mesh.h"

namespace isoshell::repair {

struct Patches {
  std::vector<uint32_t> of;  ///< per face; kNoFace for dead ones. Numbered by their smallest face
  uint32_t count = 0;
};
Patches find_patches(const RepairMesh& mesh);
std::vector<double> patch_areas(const RepairMesh& mesh, const Patches& patches);

double live_area(const RepairMesh& mesh);

/// Drops fins (see repair.h), the smallest first, until no patch is one. A T-junction counts as closed.
void drop_fins(RepairMesh& mesh, RepairReport& report);

/// Turns faces so that the faces of every patch agree as far as they can; the way round that more of them had stays.
void orient_patches(RepairMesh& mesh);

/// Drops islands (see repair.h). Patches of two faces that join count together.
void drop_islands(RepairMesh& mesh, const std::vector<std::array<uint32_t, 2>>& joins, RepairReport& report);

}  // namespace isoshell::repair
