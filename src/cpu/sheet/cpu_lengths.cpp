// The CPU's edge lengths.
#include "core/copy_product.h"
#include "cpu/cpu_backend.h"
#include "cpu/executor_tbb.h"
#include "stages/sheet/lengths_body.h"

namespace isoshell {

EdgeLengths CpuBackend::limit_edge_lengths(const SurfaceMesh& surface, Buffer<uint32_t> raw, int64_t slope_q16,
                                           Context& context) const {
  CpuExecutor exec(context, "lengths");
  return run_with_threads(context,
                          [&] { return limit_edge_lengths_body(exec, *OnHost(surface), raw.to_host(), slope_q16); });
}

EdgeLengths CpuBackend::smooth_edge_lengths(const SurfaceMesh& surface, const EdgeLengths& lengths, int32_t rounds,
                                            Context& context) const {
  CpuExecutor exec(context, "lengths");
  return run_with_threads(
      context, [&] { return smooth_edge_lengths_body(exec, *OnHost(surface), lengths.at.to_host(), rounds); });
}

int64_t CpuBackend::seed_shares(const SurfaceMesh& surface, Context& context) const {
  CpuExecutor exec(context, "lengths");
  return run_with_threads(context, [&] { return seed_shares_body(exec, *OnHost(surface)); });
}

EdgeLengths CpuBackend::transfer_edge_lengths(const SurfaceMesh& from, int halvings, const SurfaceMesh& to,
                                              Context& context) const {
  CpuExecutor exec(context, "lengths");
  return run_with_threads(context,
                          [&] { return transfer_edge_lengths_body(exec, *OnHost(from), halvings, *OnHost(to)); });
}

Buffer<uint32_t> CpuBackend::measure_curvature(const SurfaceMesh& surface, int32_t rounds, Context& context) const {
  CpuExecutor exec(context, "lengths");
  return run_with_threads(context, [&] { return measure_curvature_body(exec, *OnHost(surface), rounds); });
}

}  // namespace isoshell
