// CUDA's sum_distances.
#include "core/vector_view.h"
#include "cuda/cuda_backend.h"
#include "cuda/distance/distance_cooperative.cuh"
#include "cuda/runtime/executor_cuda.cuh"
#include "stages/distance/distance_body.h"

namespace isoshell {

DistanceSums CudaBackend::sum_distances(const TriangleMesh& from, const std::vector<double>& area_until,
                                        const TriangleGridView& to, const DistancePlaces& places,
                                        Context& context) const {
  CudaExecutor exec(context, "distance");
  const auto vertices = exec.upload(view_of(from.vertices)), to_vertices = exec.upload(to.vertices);
  const auto triangles = exec.upload(view_of(from.triangles)), to_triangles = exec.upload(to.triangles);
  const auto areas = exec.upload(view_of(area_until));
  const auto first = exec.upload(to.first), listed = exec.upload(to.listed);
  const auto block_used = exec.upload(to.block_used);
  TriangleGridView grid = to;
  grid.vertices = to_vertices.view();
  grid.triangles = to_triangles.view();
  grid.first = first.view();
  grid.listed = listed.view();
  grid.block_used = block_used.view();
  return sum_distances_body(exec, {vertices.view(), triangles.view(), areas.view()}, grid, places);
}

}  // namespace isoshell
