// index_leaves on the CPU, for sets that no stage made.
#include "core/voxel_set.h"
#include "cpu/executor_tbb.h"
#include "stages/sparse/index_leaves.h"

namespace isoshell {

void index_host_leaves(VoxelSet& set, const int32_t extent_vox[3]) {
  Context context;
  CpuExecutor exec(context, "index");
  index_leaves(exec, set, extent_vox);
}

}  // namespace isoshell
