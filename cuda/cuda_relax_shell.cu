// CUDA's relax_in_shell.
#include "cuda/cuda_backend.h"
#include "cuda/executor_cuda.cuh"
#include "stages/relax_shell_body.h"

namespace isoshell {

RelaxReport cuda_relax_in_shell(const Shell& shell, const SiteSet& sites, const SiteSamples& samples, SeedSet& seeds,
                                const RelaxOptions& options, Context& context) {
  CudaExecutor exec(context, "relax_shell");
  return relax_in_shell_body(exec, *OnDevice<Shell>(exec, shell), *OnDevice<SiteSet>(exec, sites),
                             *OnDevice<SiteSamples>(exec, samples), on_device(exec, seeds), options);
}

}  // namespace isoshell
