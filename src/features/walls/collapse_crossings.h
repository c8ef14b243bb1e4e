// Fine triangles that rounding to the lattice made meet.
#pragma once

#include "features/walls/wall_mesh.h"

namespace isoshell {

/// Collapses edges of triangles that meet others, the shortest ones first, as long as they are shorter than
/// `longest_q8`: where a surface is parted by less than a step of the lattice, its fine triangles meet once they are
/// rounded, and would go on doing so as they become coarser. What stays is left as it is. Cost: a look at all
/// triangles for those that meet, and one around each collapse.
void collapse_crossings(WallMesh& mesh, double longest_q8, const Context& context);

}  // namespace isoshell
