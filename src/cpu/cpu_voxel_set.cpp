// index_leaves for sets that were read or written on the host.
#include "core/voxel_set.h"
#include "cpu/executor_tbb.h"
#include "stages/index_leaves.h"

namespace isoshell {

void index_leaves(VoxelSet& set, const int32_t extent_vox[3]) {
  Context context;
  TbbExecutor exec(context, "index");
  index_leaves(exec, set, extent_vox);
}

}  // namespace isoshell
