// The CPU's subdivide_seeds and drop_crowded_seeds.
#include "core/copy_product.h"
#include "cpu/cpu_backend.h"
#include "cpu/executor_tbb.h"
#include "stages/crowding_body.h"
#include "stages/subdivide_body.h"

namespace isoshell {

SeedSet cpu_subdivide_seeds(const Sheet& sheet, const DualMesh& mesh, const SeedSet& seeds, int64_t target,
                            Context& context) {
  TbbExecutor exec(context, "subdivide");
  return run_with_threads(
      context, [&] { return subdivide_seeds_body(exec, *OnHost(sheet), *OnHost(mesh), *OnHost(seeds), target); });
}

void cpu_drop_crowded_seeds(const DualMesh& mesh, int64_t excess, int64_t protected_count, SeedSet& seeds,
                            Context& context) {
  TbbExecutor exec(context, "crowding");
  run_with_threads(context,
                   [&] { drop_crowded_seeds_body(exec, *OnHost(mesh), excess, protected_count, on_host(seeds)); });
}

}  // namespace isoshell
