// CUDA's edge lengths.
#include "cuda/cuda_backend.h"
#include "cuda/runtime/executor_cuda.cuh"
#include "stages/sheet/lengths_body.h"

namespace isoshell {

void CudaBackend::set_edge_lengths(SurfaceMesh& surface, Buffer<uint32_t> raw, int64_t slope_q16,
                                   Context& context) const {
  CudaExecutor exec(context, "lengths");
  set_edge_lengths_body(exec, on_device(exec, surface), exec.to_device(raw), slope_q16);
}

void CudaBackend::smooth_edge_lengths(SurfaceMesh& surface, int32_t rounds, Context& context) const {
  CudaExecutor exec(context, "lengths");
  smooth_edge_lengths_body(exec, on_device(exec, surface), rounds);
}

int64_t CudaBackend::seed_shares(const SurfaceMesh& surface, Context& context) const {
  CudaExecutor exec(context, "lengths");
  return seed_shares_body(exec, *OnDevice<SurfaceMesh>(exec, surface));
}

void CudaBackend::copy_edge_lengths(const SurfaceMesh& from, int halvings, SurfaceMesh& to, Context& context) const {
  CudaExecutor exec(context, "lengths");
  copy_edge_lengths_body(exec, *OnDevice<SurfaceMesh>(exec, from), halvings, on_device(exec, to));
}

Buffer<uint32_t> CudaBackend::measure_curvature(const SurfaceMesh& surface, int32_t rounds, Context& context) const {
  CudaExecutor exec(context, "lengths");
  return measure_curvature_body(exec, *OnDevice<SurfaceMesh>(exec, surface), rounds);
}

}  // namespace isoshell
