// A VoxelSet again, of what was kept of it elsewhere.
#pragma once

#include "isoshell/advanced/voxel_set.h"

namespace isoshell {

/// The set of these leaves, in host memory, for who has kept keys and masks of one. Throws: usage unless the extent is
/// that of a lattice, the keys ascend and lie in it, and every mask has a voxel.
VoxelSet voxel_set_of_leaves(Buffer<uint64_t> leaf_key, Buffer<LeafMask> mask, const int32_t extent_vox[3]);

}  // namespace isoshell
