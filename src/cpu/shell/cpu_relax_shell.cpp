// The CPU's relax_in_shell.
#include "core/copy_product.h"
#include "cpu/cpu_backend.h"
#include "cpu/executor_tbb.h"
#include "stages/shell/relax_shell_body.h"

namespace isoshell {

RelaxReport CpuBackend::relax_in_shell(const Shell& shell, const SiteSet& sites, const SiteSamples& samples,
                                       SeedSet& seeds, const RelaxOptions& options, Context& context) const {
  CpuExecutor exec(context, "relax_shell");
  return run_with_threads(context, [&] {
    return relax_in_shell_body(exec, *OnHost(shell), *OnHost(sites), *OnHost(samples), on_host(seeds), options);
  });
}

}  // namespace isoshell
