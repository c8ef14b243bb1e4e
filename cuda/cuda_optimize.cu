// CUDA's optimize_mesh.
#include "cuda/cuda_backend.h"
#include "cuda/executor_cuda.cuh"
#include "cuda/label_cooperative.cuh"
#include "cuda/optimize_kernels.cuh"
#include "stages/optimize_body.h"

namespace isoshell {

OptimizeReport CudaBackend::optimize_mesh(const Sheet& sheet, const OptimizeOptions& options, SeedSet& seeds,
                                          DualMesh& mesh, Context& context) const {
  CudaExecutor exec(context, "post");
  return optimize_mesh_body(exec, *OnDevice<Sheet>(exec, sheet), options, on_device(exec, seeds),
                            on_device(exec, mesh));
}

}  // namespace isoshell
