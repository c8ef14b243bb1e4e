// CUDA's attach_to_sheet.
#include "cuda/cuda_backend.h"
#include "cuda/relax/attach_cooperative.cuh"
#include "cuda/runtime/executor_cuda.cuh"
#include "stages/relax/attach_seeds_body.h"

namespace isoshell {

void CudaBackend::attach_to_sheet(const SurfaceMesh& surface, SeedSet& seeds, int halvings, Context& context) const {
  CudaExecutor exec(context, "attach");
  attach_to_sheet_body(exec, *OnDevice<SurfaceMesh>(exec, surface), on_device(exec, seeds), halvings);
}

}  // namespace isoshell
