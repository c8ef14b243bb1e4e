// CUDA's subdivide_seeds.
#include "cuda/cuda_backend.h"
#include "cuda/executor_cuda.cuh"
#include "stages/subdivide_body.h"

namespace isoshell {

SeedSet cuda_subdivide_seeds(const Sheet& sheet, const DualMesh& mesh, const SeedSet& seeds, int64_t target,
                             Context& context) {
  CudaExecutor exec(context, "subdivide");
  return subdivide_seeds_body(exec, *OnDevice<Sheet>(exec, sheet), *OnDevice<DualMesh>(exec, mesh),
                              *OnDevice<SeedSet>(exec, seeds), target);
}

}  // namespace isoshell
