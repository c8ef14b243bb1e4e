// The CPU's edge lengths.
#include "core/copy_product.h"
#include "cpu/cpu_backend.h"
#include "cpu/executor_tbb.h"
#include "stages/sheet/lengths_body.h"

namespace isoshell {

void CpuBackend::set_edge_lengths(SurfaceMesh& surface, Buffer<uint32_t> raw, int64_t slope_q16,
                                  Context& context) const {
  CpuExecutor exec(context, "lengths");
  run_with_threads(context, [&] { set_edge_lengths_body(exec, on_host(surface), raw.to_host(), slope_q16); });
}

void CpuBackend::smooth_edge_lengths(SurfaceMesh& surface, int32_t rounds, Context& context) const {
  CpuExecutor exec(context, "lengths");
  run_with_threads(context, [&] { smooth_edge_lengths_body(exec, on_host(surface), rounds); });
}

int64_t CpuBackend::seed_shares(const SurfaceMesh& surface, Context& context) const {
  CpuExecutor exec(context, "lengths");
  return run_with_threads(context, [&] { return seed_shares_body(exec, *OnHost(surface)); });
}

void CpuBackend::copy_edge_lengths(const SurfaceMesh& from, int halvings, SurfaceMesh& to, Context& context) const {
  CpuExecutor exec(context, "lengths");
  run_with_threads(context, [&] { copy_edge_lengths_body(exec, *OnHost(from), halvings, on_host(to)); });
}

Buffer<uint32_t> CpuBackend::measure_curvature(const SurfaceMesh& surface, int32_t rounds, Context& context) const {
  CpuExecutor exec(context, "lengths");
  return run_with_threads(context, [&] { return measure_curvature_body(exec, *OnHost(surface), rounds); });
}

}  // namespace isoshell
