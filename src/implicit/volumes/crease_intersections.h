// Where triangles beside creases intersect.
#pragma once

#include <vector>

#include "isoshell/advanced/lattice.h"
#include "isoshell/surface_source.h"

namespace isoshell {

/// Vertices marked in `is_crease`, ascending, of triangles that intersect others. Positions are in voxels; they are
/// tested exactly after rounding to 1/65536. With `moved`, only near these cells: those of the vertices that moved
/// since nothing but what was returned intersected. Cost: a sort of the triangles with a marked vertex, by the cells
/// that they reach into, and a search for each cell of the others.
std::vector<uint32_t> find_intersecting(const TriangleSoup& soup, const std::vector<uint8_t>& is_crease,
                                        const std::vector<Voxel>* moved = nullptr);

}  // namespace isoshell
