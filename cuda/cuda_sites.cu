// CUDA's voxelize.
#include "cuda/cuda_backend.h"
#include "cuda/executor_cuda.cuh"
#include "stages/sites_body.h"

namespace isoshell {

SiteSet cuda_voxelize(const LatticeSurface& surface, Context& context) {
  CudaExecutor exec(context, "sites");
  return voxelize_body(exec, *OnDevice<LatticeSurface>(exec, surface));
}

}  // namespace isoshell
