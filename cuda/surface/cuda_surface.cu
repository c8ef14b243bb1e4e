// CUDA's measure_topology and snap_surface.
#include "core/vector_view.h"
#include "cuda/cuda_backend.h"
#include "cuda/runtime/executor_cuda.cuh"
#include "cuda/surface/surface_cooperative.cuh"
#include "stages/surface/surface_body.h"
#include "stages/surface/topology_body.h"

namespace isoshell {
namespace {

/// A soup in device memory.
struct DeviceSoup {
  Buffer<WorldPoint> vertices;
  Buffer<std::array<uint32_t, 3>> triangles;
  DeviceSoup(CudaExecutor& exec, const TriangleSoup& soup)
      : vertices(exec.upload(view_of(soup.vertices))), triangles(exec.upload(view_of(soup.triangles))) {}
  SoupView view() const { return {vertices.view(), triangles.view()}; }
};

}  // namespace

InputTopology CudaBackend::measure_topology(const TriangleSoup& soup, DirtCounts& dirt, Context& context) const {
  CudaExecutor exec(context, "surface");
  return measure_topology_body(exec, DeviceSoup(exec, soup).view(), dirt);
}

LatticeSurface CudaBackend::snap_surface(const TriangleSoup& soup, const LatticeFrame& frame, Context& context) const {
  CudaExecutor exec(context, "surface");
  return snap_surface_body(exec, DeviceSoup(exec, soup).view(), frame);
}

}  // namespace isoshell
