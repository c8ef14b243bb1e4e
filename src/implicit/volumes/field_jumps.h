// How steep a field of distances is where its surface is, and where it jumps instead.
#pragma once

#include "implicit/volumes/cell_window.h"

namespace isoshell {

/// Distances jump to the value of the background at the end of a band that is there on one side of a surface alone, and
/// where a grid was clipped. Result: the largest difference between neighbours that is no jump, about twice as much as
/// the field rises a voxel in the less steep quarter of the cells that the surface crosses. 0 where nothing crosses, or
/// nearly all of it jumps: then values are no distances. Cost: two passes over the blocks.
double most_rise_of(const ScalarField& field, Inside inside);

/// Whether a field jumps along an edge of a cell of a window.
bool jumps_in_cell(const float* corner, double most_rise, double background);

}  // namespace isoshell
