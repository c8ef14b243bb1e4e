// The CPU's build_shell.
#include "core/copy_product.h"
#include "cpu/cpu_backend.h"
#include "cpu/executor_tbb.h"
#include "cpu/shell/leaf_simd.h"
#include "stages/shell/shell_body.h"

namespace isoshell {

Shell CpuBackend::build_shell(const SiteSet& sites, const ShellOptions& options, Context& context) const {
  CpuExecutor exec(context, "shell");
  return run_with_threads(context, [&] { return build_shell_body(exec, *OnHost(sites), options); });
}

}  // namespace isoshell
