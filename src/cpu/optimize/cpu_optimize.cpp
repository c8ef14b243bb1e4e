// The CPU's optimize_mesh.
#include "core/copy_product.h"
#include "cpu/cpu_backend.h"
#include "cpu/executor_tbb.h"
#include "cpu/optimize/mesh_passes_simd.h"
#include "cpu/optimize/optimize_simd.h"
#include "cpu/relax/label_simd.h"
#include "cpu/relax/walk_ahead.h"
#include "stages/optimize/optimize_body.h"

namespace isoshell {

OptimizeReport CpuBackend::optimize_mesh(const SurfaceMesh& surface, const OptimizeOptions& options, SeedSet& seeds,
                                         DualMesh& mesh, Context& context) const {
  CpuExecutor exec(context, "post");
  return run_with_threads(
      context, [&] { return optimize_mesh_body(exec, *OnHost(surface), options, on_host(seeds), on_host(mesh)); });
}

}  // namespace isoshell
