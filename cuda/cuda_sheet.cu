// CUDA's build_sheet.
#include "cuda/cuda_backend.h"
#include "cuda/executor_cuda.cuh"
#include "stages/sheet_body.h"

namespace isoshell {

Sheet cuda_build_sheet(const LatticeSurface& surface, const SiteSet& sites, const SiteSamples& samples,
                       const SheetOptions& options, Context& context) {
  CudaExecutor exec(context, "sheet");
  return build_sheet_body(exec, *OnDevice<LatticeSurface>(exec, surface), *OnDevice<SiteSet>(exec, sites),
                          *OnDevice<SiteSamples>(exec, samples), options);
}

}  // namespace isoshell
