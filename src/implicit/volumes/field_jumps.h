// How steep a field of distances is where its surface is, and where it jumps instead.
#pragma once

#include "implicit/volumes/cell_window.h"

namespace isoshell {

/// The largest difference between neighbours of a field of distances that is no jump: twice as much as the field rises a
/// voxel in the less steep quarter of the cells that the surface crosses, and a little. Distances jump at the end of a band that is there on one
/// side of a surface alone, and where a grid was clipped. 0 where nothing crosses. Cost: a pass over the blocks.
double most_rise_of(const ScalarField& field, Inside inside);

/// Whether a field rises more than so much along an edge of a cell of a window.
bool jumps_in_cell(const float* corner, double most_rise);

}  // namespace isoshell
