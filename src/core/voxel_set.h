// VoxelSets on the host.
#pragma once

#include "isoshell/advanced/voxel_set.h"
#include "voxel/leaf.h"

namespace isoshell {

/// index_leaves (see stages/sparse/index_leaves.h) of a set that was read or written on the host.
void index_host_leaves(VoxelSet& set, const int32_t extent_vox[3]);

/// Calls visit(voxel, index) for the active voxels of a set, in their order.
template <class Visit>
void for_each_voxel(const VoxelSetView& set, Visit visit) {
  for (int64_t leaf = 0; leaf < set.leaf_key.size; ++leaf)
    for_each_active(set, leaf,
                    [&](int offset, int64_t i) { visit(voxel_at(leaf_of_key(set.leaf_key[leaf]), offset), i); });
}

}  // namespace isoshell
