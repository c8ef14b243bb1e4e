// Whether a field's surface is one of sharp sides, said by the bends of the cells that it crosses.
#pragma once

#include <vector>

#include "implicit/volumes/cell_window.h"

namespace isoshell {

/// How much a field rises a voxel beside its surface: the median over the cut cells of a block, then over blocks, of
/// which a few hundred are looked at. 0 without a cut cell.
double usual_rise(const ScalarField& field, Inside inside, const std::vector<Voxel>& blocks);

/// Cells that the surface crosses.
struct BentCells {
  uint32_t all = 0, bent = 0, very_bent = 0;

  void add(const float* corner, double usual_rise);
};

/// Around the creases of sharp bodies few cells are bent, and many of these are so by much; on smooth bodies that are
/// bent as much anywhere, most are bent by less. Densities are bent everywhere.
bool is_sharp(const std::vector<BentCells>& of_blocks);

}  // namespace isoshell
