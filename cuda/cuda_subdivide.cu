// CUDA's subdivide_seeds and drop_crowded_seeds.
#include "cuda/cuda_backend.h"
#include "cuda/executor_cuda.cuh"
#include "stages/crowding_body.h"
#include "stages/subdivide_body.h"

namespace isoshell {

SeedSet cuda_subdivide_seeds(const Sheet& sheet, const DualMesh& mesh, const SeedSet& seeds, int64_t target,
                             Context& context) {
  CudaExecutor exec(context, "subdivide");
  return subdivide_seeds_body(exec, *OnDevice<Sheet>(exec, sheet), *OnDevice<DualMesh>(exec, mesh),
                              *OnDevice<SeedSet>(exec, seeds), target);
}

void cuda_drop_crowded_seeds(const DualMesh& mesh, int64_t excess, int64_t protected_count, SeedSet& seeds,
                             Context& context) {
  CudaExecutor exec(context, "crowding");
  drop_crowded_seeds_body(exec, *OnDevice<DualMesh>(exec, mesh), excess, protected_count, on_device(exec, seeds));
}

}  // namespace isoshell
