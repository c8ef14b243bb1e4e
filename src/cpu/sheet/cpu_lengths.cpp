// The CPU's edge lengths.
#include "core/copy_product.h"
#include "cpu/cpu_backend.h"
#include "cpu/executor_tbb.h"
#include "stages/sheet/lengths_body.h"

namespace isoshell {

void CpuBackend::set_edge_lengths(Sheet& sheet, Buffer<uint32_t> raw, int64_t slope_q16, Context& context) const {
  CpuExecutor exec(context, "lengths");
  run_with_threads(context, [&] { set_edge_lengths_body(exec, on_host(sheet), raw.to_host(), slope_q16); });
}

void CpuBackend::smooth_edge_lengths(Sheet& sheet, int32_t rounds, Context& context) const {
  CpuExecutor exec(context, "lengths");
  run_with_threads(context, [&] { smooth_edge_lengths_body(exec, on_host(sheet), rounds); });
}

int64_t CpuBackend::seed_shares(const Sheet& sheet, Context& context) const {
  CpuExecutor exec(context, "lengths");
  return run_with_threads(context, [&] { return seed_shares_body(exec, *OnHost(sheet)); });
}

void CpuBackend::copy_edge_lengths(const Sheet& from, int halvings, Sheet& to, Context& context) const {
  CpuExecutor exec(context, "lengths");
  run_with_threads(context, [&] { copy_edge_lengths_body(exec, *OnHost(from), halvings, on_host(to)); });
}

Buffer<uint32_t> CpuBackend::measure_curvature(const Sheet& sheet, int32_t rounds, Context& context) const {
  CpuExecutor exec(context, "lengths");
  return run_with_threads(context, [&] { return measure_curvature_body(exec, *OnHost(sheet), rounds); });
}

}  // namespace isoshell
