// Which voxels the shell's leaves hold.
#pragma once

#include "cuda/shell/row_transform.cuh"

namespace isoshell {

/// Fills the masks and the leaves' numbers of voxels.
void find_shell_masks(CudaExecutor& exec, const closest::Arguments& arguments);

}  // namespace isoshell
