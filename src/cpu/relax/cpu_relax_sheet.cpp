// The CPU's relax_on_sheet.
#include "core/copy_product.h"
#include "cpu/cpu_backend.h"
#include "cpu/executor_tbb.h"
#include "cpu/relax/pass_simd.h"
#include "cpu/relax/walk_ahead.h"
#include "stages/relax/relax_sheet_body.h"

namespace isoshell {

RelaxReport CpuBackend::relax_on_sheet(const SurfaceMesh& surface, SeedSet& seeds, const RelaxOptions& options,
                                       Context& context) const {
  CpuExecutor exec(context, "relax_sheet");
  return run_with_threads(context,
                          [&] { return relax_on_sheet_body(exec, *OnHost(surface), on_host(seeds), options); });
}

}  // namespace isoshell
