// CUDA's relax_on_sheet.
#include "cuda/cuda_backend.h"
#include "cuda/executor_cuda.cuh"
#include "cuda/label_forms.cuh"
#include "stages/relax_sheet_body.h"

namespace isoshell {

RelaxReport cuda_relax_on_sheet(const Sheet& sheet, SeedSet& seeds, const RelaxOptions& options, Context& context) {
  CudaExecutor exec(context, "relax_sheet");
  return relax_on_sheet_body(exec, *OnDevice<Sheet>(exec, sheet), on_device(exec, seeds), options);
}

}  // namespace isoshell
