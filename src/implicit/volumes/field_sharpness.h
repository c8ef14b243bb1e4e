// What the cells that a field's surface crosses say of it: whether its sides are sharp, and where values jump.
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

/// Distances jump to the value of the background at the end of a band that is there on one side of a surface alone, and
/// where a grid was clipped. Result: the largest difference between neighbours that is no jump, about twice as much as
/// the field rises a voxel in the less steep quarter of the cells that the surface crosses. 0 where nothing crosses, or
/// nearly all of it jumps: then values are no distances. Cost: two passes over the blocks.
double most_rise_of(const ScalarField& field, Inside inside);

/// Whether a field jumps along an edge of a cell of a window.
bool jumps_in_cell(const float* corner, double most_rise, double background);

}  // namespace isoshell
