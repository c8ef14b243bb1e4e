// The CPU's sample_sites.
#include "core/copy_product.h"
#include "cpu/cpu_backend.h"
#include "cpu/sites/list_site_triangles.h"

namespace isoshell {

SiteSamples CpuBackend::sample_sites(const LatticeSurface& surface, const SiteSet& sites, Context& context) const {
  CpuExecutor exec(context, "samples");
  return run_with_threads(context, [&] { return sample_sites_body(exec, *OnHost(surface), *OnHost(sites)); });
}

}  // namespace isoshell
