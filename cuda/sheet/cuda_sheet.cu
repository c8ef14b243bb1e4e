// CUDA's build_sheet and six_volume_vox.
#include "cuda/cuda_backend.h"
#include "cuda/runtime/executor_cuda.cuh"
#include "cuda/sheet/project_leaves.cuh"
#include "cuda/sheet/sheet_components.cuh"
#include "cuda/sheet/sheet_cooperative.cuh"
#include "cuda/sheet/sheet_flood.cuh"
#include "stages/sheet/sheet_body.h"
#include "stages/sheet/sheet_volume_body.h"
#include "stages/sites/coarsen_sites_body.h"

namespace isoshell {

Shell CudaBuildShell::run(CudaExecutor& exec, const SiteSet& sites, const ShellOptions& options) {
  return CudaBackend().build_shell(sites, options, exec.context());
}

Sheet CudaBackend::build_sheet(const LatticeSurface& surface, const SiteSet& solid_voxels, const SiteSet& sites,
                               const SiteSamples& samples, SiteSamples* spent, const SheetOptions& options,
                               Context& context) const {
  CudaExecutor exec(context, "sheet");
  return build_sheet_body(exec, *OnDevice<LatticeSurface>(exec, surface), *OnDevice<SiteSet>(exec, solid_voxels),
                          *OnDevice<SiteSet>(exec, sites), *OnDevice<SiteSamples>(exec, samples), spent, options);
}

SiteSet CudaBackend::coarsen_sites(const SiteSet& sites, Context& context) const {
  CudaExecutor exec(context, "coarsen");
  return coarsen_sites_body(exec, *OnDevice<SiteSet>(exec, sites));
}

Sheet CudaBackend::build_proxy(const SiteSet& sites, const LatticeFrame& frame, const SheetOptions& options,
                               Context& context) const {
  CudaExecutor exec(context, "coarse proxy");
  return build_proxy_body(exec, *OnDevice<SiteSet>(exec, sites), frame, options);
}

int64_t CudaBackend::six_volume_vox(const SurfaceMesh& surface, Context& context) const {
  CudaExecutor exec(context, "sheet");
  return six_volume_vox_body(exec, *OnDevice<SurfaceMesh>(exec, surface));
}

}  // namespace isoshell
