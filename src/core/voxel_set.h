// Builds the index of a VoxelSet from its sorted leaves.
#pragma once

#include "isoshell/advanced/voxel_set.h"

namespace isoshell {

/// index_leaves (see stages/sparse/index_leaves.h) of a set that was read or written on the host.
void index_host_leaves(VoxelSet& set, const int32_t extent_vox[3]);

}  // namespace isoshell
