// CUDA's edge lengths.
#include "cuda/cuda_backend.h"
#include "cuda/runtime/executor_cuda.cuh"
#include "stages/sheet/lengths_body.h"

namespace isoshell {

EdgeLengths CudaBackend::limit_edge_lengths(const SurfaceMesh& surface, Buffer<uint32_t> raw, int64_t slope_q16,
                                            Context& context) const {
  CudaExecutor exec(context, "lengths");
  return limit_edge_lengths_body(exec, *OnDevice<SurfaceMesh>(exec, surface), exec.to_device(raw), slope_q16);
}

EdgeLengths CudaBackend::smooth_edge_lengths(const SurfaceMesh& surface, const EdgeLengths& lengths, int32_t rounds,
                                             Context& context) const {
  CudaExecutor exec(context, "lengths");
  return smooth_edge_lengths_body(exec, *OnDevice<SurfaceMesh>(exec, surface), exec.to_device(lengths.at), rounds);
}

int64_t CudaBackend::seed_shares(const SurfaceMesh& surface, Context& context) const {
  CudaExecutor exec(context, "lengths");
  return seed_shares_body(exec, *OnDevice<SurfaceMesh>(exec, surface));
}

EdgeLengths CudaBackend::transfer_edge_lengths(const SurfaceMesh& from, int halvings, const SurfaceMesh& to,
                                               Context& context) const {
  CudaExecutor exec(context, "lengths");
  return transfer_edge_lengths_body(exec, *OnDevice<SurfaceMesh>(exec, from), halvings,
                                    *OnDevice<SurfaceMesh>(exec, to));
}

Buffer<uint32_t> CudaBackend::measure_curvature(const SurfaceMesh& surface, int32_t rounds, Context& context) const {
  CudaExecutor exec(context, "lengths");
  return measure_curvature_body(exec, *OnDevice<SurfaceMesh>(exec, surface), rounds);
}

}  // namespace isoshell
