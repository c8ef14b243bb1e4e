// The CPU's build_sheet and six_volume_vox.
#include "core/copy_product.h"
#include "cpu/cpu_backend.h"
#include "cpu/executor_tbb.h"
#include "cpu/sheet/list_triangles_around.h"
#include "cpu/sheet/project_simd.h"
#include "stages/sheet/sheet_body.h"
#include "stages/sheet/sheet_volume_body.h"
#include "stages/sites/coarsen_sites_body.h"

namespace isoshell {

Sheet CpuBackend::build_sheet(const LatticeSurface& surface, const SiteSet& solid_voxels, const SiteSet& sites,
                              const SiteSamples& samples, SiteSamples* spent, const SheetOptions& options,
                              Context& context) const {
  CpuExecutor exec(context, "sheet");
  return run_with_threads(context, [&] {
    return build_sheet_body(exec, *OnHost(surface), *OnHost(solid_voxels), *OnHost(sites), *OnHost(samples), spent,
                            options);
  });
}

SiteSet CpuBackend::coarsen_sites(const SiteSet& sites, Context& context) const {
  CpuExecutor exec(context, "coarsen");
  return run_with_threads(context, [&] { return coarsen_sites_body(exec, *OnHost(sites)); });
}

Sheet CpuBackend::build_proxy(const SiteSet& sites, const LatticeFrame& frame, const SheetOptions& options,
                              Context& context) const {
  CpuExecutor exec(context, "coarse proxy");
  return run_with_threads(context, [&] { return build_proxy_body(exec, *OnHost(sites), frame, options); });
}

int64_t CpuBackend::six_volume_vox(const SurfaceMesh& surface, Context& context) const {
  CpuExecutor exec(context, "sheet");
  return run_with_threads(context, [&] { return six_volume_vox_body(exec, *OnHost(surface)); });
}

}  // namespace isoshell
