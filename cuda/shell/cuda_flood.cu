// CUDA's flood_shell.
#include "cuda/cuda_backend.h"
#include "cuda/runtime/executor_cuda.cuh"
#include "cuda/shell/flood_cooperative.cuh"
#include "stages/shell/flood_body.h"

namespace isoshell {

VoronoiLabels CudaBackend::flood_shell(const Shell& shell, const SeedSet& seeds, Context& context) const {
  CudaExecutor exec(context, "flood");
  return flood_shell_body(exec, *OnDevice<Shell>(exec, shell), *OnDevice<SeedSet>(exec, seeds));
}

}  // namespace isoshell
