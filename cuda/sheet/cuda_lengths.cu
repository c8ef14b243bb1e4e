// CUDA's edge lengths.
#include "cuda/cuda_backend.h"
#include "cuda/runtime/executor_cuda.cuh"
#include "stages/sheet/lengths_body.h"

namespace isoshell {

void CudaBackend::set_edge_lengths(Sheet& sheet, Buffer<uint32_t> raw, int64_t slope_q16, Context& context) const {
  CudaExecutor exec(context, "lengths");
  set_edge_lengths_body(exec, on_device(exec, sheet), exec.to_device(raw), slope_q16);
}

void CudaBackend::smooth_edge_lengths(Sheet& sheet, int32_t rounds, Context& context) const {
  CudaExecutor exec(context, "lengths");
  smooth_edge_lengths_body(exec, on_device(exec, sheet), rounds);
}

int64_t CudaBackend::seed_shares(const Sheet& sheet, Context& context) const {
  CudaExecutor exec(context, "lengths");
  return seed_shares_body(exec, *OnDevice<Sheet>(exec, sheet));
}

void CudaBackend::copy_edge_lengths(const Sheet& from, int halvings, Sheet& to, Context& context) const {
  CudaExecutor exec(context, "lengths");
  copy_edge_lengths_body(exec, *OnDevice<Sheet>(exec, from), halvings, on_device(exec, to));
}

Buffer<uint32_t> CudaBackend::measure_curvature(const Sheet& sheet, int32_t rounds, Context& context) const {
  CudaExecutor exec(context, "lengths");
  return measure_curvature_body(exec, *OnDevice<Sheet>(exec, sheet), rounds);
}

}  // namespace isoshell
