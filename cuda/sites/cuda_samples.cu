// CUDA's sample_sites.
#include "cuda/cuda_backend.h"
#include "cuda/runtime/executor_cuda.cuh"
#include "cuda/sites/sample_cooperative.cuh"
#include "stages/sites/samples_body.h"

namespace isoshell {

SiteSamples CudaBackend::sample_sites(const LatticeSurface& surface, const SiteSet& sites, Context& context) const {
  CudaExecutor exec(context, "samples");
  return sample_sites_body(exec, *OnDevice<LatticeSurface>(exec, surface), *OnDevice<SiteSet>(exec, sites));
}

}  // namespace isoshell
