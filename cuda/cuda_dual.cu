// CUDA's triangulate_dual.
#include "cuda/cuda_backend.h"
#include "cuda/executor_cuda.cuh"
#include "cuda/label_cooperative.cuh"
#include "cuda/pieces_cooperative.cuh"
#include "cuda/split_cells.cuh"
#include "stages/dual_body.h"

namespace isoshell {

DualMesh CudaBackend::triangulate_dual(const Sheet& sheet, SeedSet& seeds, const DualOptions& options,
                                       DualReport& report, Context& context) const {
  CudaExecutor exec(context, "dual");
  return triangulate_dual_body(exec, *OnDevice<Sheet>(exec, sheet), on_device(exec, seeds), options, report);
}

}  // namespace isoshell
