// index_leaves on the CPU, for sets that no stage made.
#include <utility>

#include "core/voxel_set.h"
#include "cpu/executor_tbb.h"
#include "isoshell/advanced/voxel_set_of_leaves.h"
#include "isoshell/error.h"
#include "stages/sparse/index_leaves.h"

namespace isoshell {

void index_host_leaves(VoxelSet& set, const int32_t extent_vox[3]) {
  Context context;
  CpuExecutor exec(context, "index");
  index_leaves(exec, set, extent_vox);
}

VoxelSet voxel_set_of_leaves(Buffer<uint64_t> leaf_key, Buffer<LeafMask> mask, const int32_t extent_vox[3]) {
  const auto refuse = [](const char* what) { throw Error(ErrorCode::usage, "voxels", what); };
  constexpr int32_t kMostVox = 2 * kMaxResolution;
  for (int axis = 0; axis < 3; ++axis)
    if (extent_vox[axis] < 8 || extent_vox[axis] > kMostVox || extent_vox[axis] % 8 != 0)
      refuse("the extent of a set of voxels must be whole leaves of a lattice");
  if (leaf_key.size() != mask.size()) refuse("a set of voxels has one mask a leaf");
  for (int64_t i = 0; i < leaf_key.size(); ++i) {
    const Voxel leaf = leaf_of_key(leaf_key[i]);
    const bool is_within = leaf.x < extent_vox[0] / 8 && leaf.y < extent_vox[1] / 8 && leaf.z < extent_vox[2] / 8;
    if (!is_within || isoshell::leaf_key(leaf) != leaf_key[i])
      refuse("a leaf of a set of voxels lies out of its extent");
    if (i > 0 && leaf_key[i] <= leaf_key[i - 1]) refuse("leaves of a set of voxels come in the order of their keys");
    uint64_t any = 0;
    for (const uint64_t word : mask[i].word) any |= word;
    if (any == 0) refuse("a leaf of a set of voxels has none");
  }
  VoxelSet set;
  set.leaf_key = std::move(leaf_key);
  set.mask = std::move(mask);
  index_host_leaves(set, extent_vox);
  return set;
}

}  // namespace isoshell
