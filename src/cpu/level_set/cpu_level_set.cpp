// The CPU's build_level_set.
#include "core/copy_product.h"
#include "cpu/cpu_backend.h"
#include "cpu/executor_tbb.h"
#include "cpu/shell/leaf_simd.h"
#include "stages/level_set/level_set_body.h"

namespace isoshell {

LevelSet CpuBackend::build_level_set(const LevelSetSurface& surface, const SiteSet& sites, const Sheet& sheet,
                                     const LevelSetOptions& options, Context& context) const {
  CpuExecutor exec(context, "level-set");
  return run_with_threads(context, [&] {
    return build_level_set_body(exec, surface.corner.view(), surface.first_of_sheet, *OnHost(sites), *OnHost(sheet),
                                options);
  });
}

}  // namespace isoshell
