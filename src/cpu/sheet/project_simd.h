// Projection of the sheet's vertices on the CPU: sheet_steps::ProjectVertex, with triangles taken in lanes.
#pragma once

#include "cpu/executor_tbb.h"
#include "stages/sheet/sheet_project_body.h"

namespace isoshell {

struct ProjectLanes {
  static void run(CpuExecutor& exec, const VoxelSetView& corners, const sheet_steps::ProjectVertex& step);
};

}  // namespace isoshell
