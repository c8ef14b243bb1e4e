// Builds the index of a VoxelSet from its sorted leaves.
#pragma once

#include "isoshell/voxel_set.h"

namespace isoshell {

/// Completes a VoxelSet whose leaf_key (ascending, unique) and mask are filled: first, blocks and block_table.
/// `extent_vox` is the lattice's size. Leaves must have at least one active voxel.
void index_leaves(VoxelSet& set, const int32_t extent_vox[3]);

}  // namespace isoshell
