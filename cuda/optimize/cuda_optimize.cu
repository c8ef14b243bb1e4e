// CUDA's optimize_mesh.
#include "cuda/cuda_backend.h"
#include "cuda/optimize/mesh_passes_kernel.cuh"
#include "cuda/optimize/optimize_kernels.cuh"
#include "cuda/optimize/steps_by_lanes.cuh"
#include "cuda/relax/label_cooperative.cuh"
#include "cuda/runtime/executor_cuda.cuh"
#include "stages/optimize/optimize_body.h"

namespace isoshell {

OptimizeReport CudaBackend::optimize_mesh(const SurfaceMesh& surface, const OptimizeOptions& options, SeedSet& seeds,
                                          DualMesh& mesh, Context& context) const {
  CudaExecutor exec(context, "post");
  return optimize_mesh_body(exec, *OnDevice<SurfaceMesh>(exec, surface), options, on_device(exec, seeds),
                            on_device(exec, mesh));
}

}  // namespace isoshell
