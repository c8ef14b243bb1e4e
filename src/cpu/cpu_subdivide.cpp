// The CPU's subdivide_seeds.
#include "core/copy_product.h"
#include "cpu/cpu_backend.h"
#include "cpu/executor_tbb.h"
#include "stages/subdivide_body.h"

namespace isoshell {

SeedSet cpu_subdivide_seeds(const Sheet& sheet, const DualMesh& mesh, const SeedSet& seeds, int64_t target,
                            Context& context) {
  TbbExecutor exec(context, "subdivide");
  return run_with_threads(
      context, [&] { return subdivide_seeds_body(exec, *OnHost(sheet), *OnHost(mesh), *OnHost(seeds), target); });
}

}  // namespace isoshell
