// The CPU's subdivide_seeds and collapse_edges.
#include "core/copy_product.h"
#include "cpu/cpu_backend.h"
#include "cpu/executor_tbb.h"
#include "stages/dual/collapse_body.h"
#include "stages/relax/subdivide_body.h"

namespace isoshell {

SeedSet CpuBackend::subdivide_seeds(const SurfaceMesh& surface, const DualMesh& mesh, const SeedSet& seeds,
                                    int64_t target, Context& context) const {
  CpuExecutor exec(context, "subdivide");
  return run_with_threads(
      context, [&] { return subdivide_seeds_body(exec, *OnHost(surface), *OnHost(mesh), *OnHost(seeds), target); });
}

void CpuBackend::collapse_edges(const SurfaceMesh& surface, const CollapseOptions& options, SeedSet& seeds,
                                DualMesh& mesh, Context& context) const {
  CpuExecutor exec(context, "collapse");
  run_with_threads(context,
                   [&] { collapse_edges_body(exec, *OnHost(surface), options, on_host(seeds), on_host(mesh)); });
}

}  // namespace isoshell
