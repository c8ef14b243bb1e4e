// CUDA's place_seeds.
#include "cuda/cuda_backend.h"
#include "cuda/runtime/executor_cuda.cuh"
#include "stages/relax/seeds_body.h"

namespace isoshell {

SeedSet CudaBackend::place_seeds_on_surface(const SurfaceMesh& surface, const SeedOptions& options,
                                            Context& context) const {
  CudaExecutor exec(context, "seeds");
  return place_seeds_body(exec, *OnDevice<SurfaceMesh>(exec, surface), options);
}

SeedSet CudaBackend::place_seeds_on_sites(const SiteSet& sites, const SiteSamples& samples, const SeedOptions& options,
                                          Context& context) const {
  CudaExecutor exec(context, "seeds");
  return place_seeds_body(exec, *OnDevice<SiteSet>(exec, sites), *OnDevice<SiteSamples>(exec, samples), options);
}

}  // namespace isoshell
