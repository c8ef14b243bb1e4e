// What a distance field says of the surface beside its creases, where marching cubes would cut them off.
#pragma once

#include <vector>

#include "implicit/volumes/cell_window.h"
#include "isoshell/advanced/lattice.h"

namespace isoshell {

/// A lattice edge that the surface crosses near a crease, and the plane of the side that it crosses. Interpolation is
/// wrong there, since distances around a crease are those from the crease or from the other side of it. The plane comes
/// from the nearest cells in which the field is straight.
struct CreaseCrossing {
  uint16_t edge;      ///< axis << 9 | offset of its first end in the block
  bool has_plane;     ///< false: no straight cell was found
  double place;       ///< 0 at the first end, 1 at the other
  WorldPoint normal;  ///< of the plane, outward, of length 1, in index coordinates
  double height;      ///< of the plane along the normal, from the block's origin
};

/// The edges of a block of cells beside bent cells and the cells around these, in order.
std::vector<CreaseCrossing> find_crease_crossings(const ScalarField& field, Inside inside, double rise, Voxel block);

}  // namespace isoshell
