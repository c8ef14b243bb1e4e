// The CPU's attach_to_sheet.
#include "core/copy_product.h"
#include "cpu/cpu_backend.h"
#include "cpu/executor_tbb.h"
#include "stages/relax/attach_seeds_body.h"

namespace isoshell {

void CpuBackend::attach_to_sheet(const SurfaceMesh& surface, SeedSet& seeds, int halvings, Context& context) const {
  CpuExecutor exec(context, "attach");
  run_with_threads(context, [&] { attach_to_sheet_body(exec, *OnHost(surface), on_host(seeds), halvings); });
}

}  // namespace isoshell
