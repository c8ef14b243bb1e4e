// Arms, tails and handles that a hole cuts through: what is left of them has two rims that face each other.
#pragma once

#include "repair/holes/repair_holes.h"

namespace isoshell::repair {

/// Of some loops the rims that are the ends of one tube, joined by strips of faces. Both look along the way from one to
/// the other, the surface runs along it, they are about as wide and nearer to each other than to other such rims:
/// within three diameters on one patch, within one where a patch lost an end of at most a fifth of its area. Faces
/// agree in their patches already.
std::vector<Cap> find_tubes(const RepairMesh& mesh, const std::vector<Loop>& loops);

}  // namespace isoshell::repair
