// CUDA's subdivide_seeds and collapse_edges.
#include "cuda/cuda_backend.h"
#include "cuda/runtime/executor_cuda.cuh"
#include "stages/dual/collapse_body.h"
#include "stages/relax/subdivide_body.h"

namespace isoshell {

SeedSet CudaBackend::subdivide_seeds(const SurfaceMesh& surface, const DualMesh& mesh, const SeedSet& seeds,
                                     int64_t target, Context& context) const {
  CudaExecutor exec(context, "subdivide");
  return subdivide_seeds_body(exec, *OnDevice<SurfaceMesh>(exec, surface), *OnDevice<DualMesh>(exec, mesh),
                              *OnDevice<SeedSet>(exec, seeds), target);
}

void CudaBackend::collapse_edges(const SurfaceMesh& surface, const CollapseOptions& options, SeedSet& seeds,
                                 DualMesh& mesh, Context& context) const {
  CudaExecutor exec(context, "collapse");
  collapse_edges_body(exec, *OnDevice<SurfaceMesh>(exec, surface), options, on_device(exec, seeds),
                      on_device(exec, mesh));
}

}  // namespace isoshell
