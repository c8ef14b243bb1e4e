// A VoxelSet again, of what was kept of it elsewhere.
#pragma once

#include "isoshell/advanced/voxel_set.h"

namespace isoshell {

/// The set of these leaves, in host memory, for who has kept keys and masks of one. Cost: linear in the leaves and
/// in the blocks of 16^3 leaves that the extent has room for. Throws: usage unless the extent is that of a lattice, the
/// keys ascend and lie in it, and every mask has a voxel.
VoxelSet voxel_set_of_leaves(Buffer<uint64_t> leaf_key, Buffer<LeafMask> mask, const int32_t extent_vox[3]);

}  // namespace isoshell
