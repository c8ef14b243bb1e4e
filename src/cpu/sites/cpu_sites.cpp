// The CPU's voxelize.
#include "core/copy_product.h"
#include "cpu/cpu_backend.h"
#include "cpu/executor_tbb.h"
#include "stages/sites/sites_body.h"

namespace isoshell {

SiteSet CpuBackend::voxelize(const LatticeSurface& surface, Context& context) const {
  CpuExecutor exec(context, "sites");
  return run_with_threads(context, [&] { return voxelize_body(exec, *OnHost(surface)); });
}

}  // namespace isoshell
