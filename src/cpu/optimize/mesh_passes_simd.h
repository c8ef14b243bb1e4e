// Relaxation on the mesh on the CPU: the definition is stages/optimize/optimize_mesh_passes.h.
#pragma once

#include "cpu/executor_tbb.h"
#include "stages/optimize/optimize_mesh_passes.h"

namespace isoshell {

/// optimize::PlainMeshPasses, with triangles measured in lanes, and a list of the few edges that are not Delaunay.
struct CpuMeshPasses {
  static void run(CpuExecutor& exec, const optimize::MeshPasses& passes);
};

}  // namespace isoshell
