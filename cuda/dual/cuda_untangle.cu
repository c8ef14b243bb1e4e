// CUDA's untangle_sheet.
#include "cuda/cuda_backend.h"
#include "cuda/runtime/executor_cuda.cuh"
#include "stages/dual/untangle_body.h"

namespace isoshell {

int64_t CudaBackend::untangle_sheet(Sheet& sheet, SeedSet& seeds, Context& context) const {
  CudaExecutor exec(context, "untangle");
  return untangle_sheet_body(exec, on_device(exec, sheet), on_device(exec, seeds));
}

}  // namespace isoshell
