// Where tiles of a field inside the surface meet what lies outside.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "implicit/volumes/scalar_field.h"

namespace isoshell {

/// Lexicographic order of lattice points.
inline bool comes_before(const Voxel& a, const Voxel& b) {
  return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
}

/// Blocks outside the surface, beside tiles inside it and not among `held` (sorted); in any order, some repeated.
/// Tiles of the field lie at multiples of their size, the background outside. Cost: a search for each face of a tile
/// that another tile covers, and one for each block that is added. Throws: out_of_memory for more than `most` blocks.
std::vector<Voxel> blocks_beside_tiles(const ScalarField& field, const std::function<bool(double)>& inside,
                                       const std::vector<Voxel>& held, int64_t most);

}  // namespace isoshell
