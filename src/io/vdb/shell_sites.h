// Helpers on products that stage files need.
#pragma once

#include "isoshell/advanced/voxel_set.h"

namespace isoshell {

/// Coordinates of the voxels, in canonical order.
Buffer<Voxel> list_voxels(const VoxelSet& voxels);

}  // namespace isoshell
