// The CPU's place_seeds.
#include "core/copy_product.h"
#include "cpu/cpu_backend.h"
#include "cpu/executor_tbb.h"
#include "stages/relax/seeds_body.h"

namespace isoshell {

SeedSet CpuBackend::place_seeds_on_surface(const SurfaceMesh& surface, const SeedOptions& options,
                                           Context& context) const {
  CpuExecutor exec(context, "seeds");
  return run_with_threads(context, [&] { return place_seeds_body(exec, *OnHost(surface), options); });
}

SeedSet CpuBackend::place_seeds_on_sites(const SiteSet& sites, const SiteSamples& samples, const SeedOptions& options,
                                         Context& context) const {
  CpuExecutor exec(context, "seeds");
  return run_with_threads(context, [&] { return place_seeds_body(exec, *OnHost(sites), *OnHost(samples), options); });
}

}  // namespace isoshell
