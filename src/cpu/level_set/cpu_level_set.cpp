// The CPU's build_level_set, and its surface.
#include "core/copy_product.h"
#include "core/vector_view.h"
#include "cpu/cpu_backend.h"
#include "cpu/executor_tbb.h"
#include "cpu/shell/leaf_simd.h"
#include "stages/level_set/level_set_body.h"
#include "stages/level_set/level_set_surface_body.h"

namespace isoshell {

LevelSetSurface CpuBackend::level_set_surface(const LatticeSurface& surface, const TriangleSoup* exact,
                                              const Sheet& sheet, SheetPart part, Context& context) const {
  CpuExecutor exec(context, "level-set");
  level_set_steps::ExactTriangles given;
  if (exact) given = {view_of(exact->vertices), view_of(exact->triangles)};
  return run_with_threads(context,
                          [&] { return level_set_surface_body(exec, *OnHost(surface), given, *OnHost(sheet), part); });
}

LevelSet CpuBackend::build_level_set(const LevelSetSurface& surface, const SiteSet& sites, const Sheet& sheet,
                                     const LevelSetOptions& options, Context& context) const {
  CpuExecutor exec(context, "level-set");
  return run_with_threads(
      context, [&] { return build_level_set_body(exec, *OnHost(surface), *OnHost(sites), *OnHost(sheet), options); });
}

}  // namespace isoshell
