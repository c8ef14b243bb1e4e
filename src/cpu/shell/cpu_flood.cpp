// The CPU's flood_shell.
#include "core/copy_product.h"
#include "cpu/cpu_backend.h"
#include "cpu/executor_tbb.h"
#include "stages/shell/flood_body.h"

namespace isoshell {

VoronoiLabels CpuBackend::flood_shell(const Shell& shell, const SeedSet& seeds, Context& context) const {
  CpuExecutor exec(context, "flood");
  return run_with_threads(context, [&] { return flood_shell_body(exec, *OnHost(shell), *OnHost(seeds)); });
}

}  // namespace isoshell
