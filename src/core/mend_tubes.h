// Arms, tails and handles that a hole cuts through: what is left of them has two rims that face each other.
#pragma once

#include "core/mend_holes.h"

namespace isoshell::mending {

/// Rims that are the ends of one tube, joined by strips of faces. Both look along the way from one to the other, the
/// surface runs along it, they are about as wide and nearer than five diameters, and nearer to each other than to other
/// such rims. Faces agree in their patches already.
std::vector<Cap> find_tubes(const MendMesh& mesh);

}  // namespace isoshell::mending
