// The CPU's untangle_sheet.
#include "core/copy_product.h"
#include "cpu/cpu_backend.h"
#include "cpu/executor_tbb.h"
#include "stages/dual/untangle_body.h"

namespace isoshell {

int64_t CpuBackend::untangle_sheet(Sheet& sheet, SeedSet& seeds, Context& context) const {
  CpuExecutor exec(context, "untangle");
  return run_with_threads(context, [&] { return untangle_sheet_body(exec, on_host(sheet), on_host(seeds)); });
}

}  // namespace isoshell
