// The CPU's triangulate_dual.
#include "core/copy_product.h"
#include "cpu/cpu_backend.h"
#include "cpu/executor_tbb.h"
#include "cpu/relax/label_simd.h"
#include "stages/dual/dual_body.h"

namespace isoshell {

Triangulation CpuBackend::triangulate_dual(const SurfaceMesh& surface, SeedSet&& seeds, const DualOptions& options,
                                           Context& context) const {
  CpuExecutor exec(context, "dual");
  return run_with_threads(
      context, [&] { return triangulate_dual_body(exec, *OnHost(surface), std::move(on_host(seeds)), options); });
}

}  // namespace isoshell
