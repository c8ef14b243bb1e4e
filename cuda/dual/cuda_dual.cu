// CUDA's triangulate_dual.
#include "cuda/cuda_backend.h"
#include "cuda/dual/pieces_cooperative.cuh"
#include "cuda/dual/split_cells.cuh"
#include "cuda/relax/label_cooperative.cuh"
#include "cuda/runtime/executor_cuda.cuh"
#include "stages/dual/dual_body.h"

namespace isoshell {

Triangulation CudaBackend::triangulate_dual(const SurfaceMesh& surface, SeedSet&& seeds, const DualOptions& options,
                                            Context& context) const {
  CudaExecutor exec(context, "dual");
  return triangulate_dual_body(exec, *OnDevice<SurfaceMesh>(exec, surface), std::move(on_device(exec, seeds)), options);
}

}  // namespace isoshell
