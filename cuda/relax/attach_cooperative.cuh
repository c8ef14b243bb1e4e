// Cooperative kernel of attach_to_sheet: a warp a seed. Lanes share the rows of cells around it; one then
// looks at the triangles of its vertex.
#pragma once

#include "cuda/runtime/cooperative_kernel.cuh"
#include "stages/relax/attach_seeds_body.h"

namespace isoshell {
namespace attach_cooperative {

/// nearest_point by a warp: the same rings of cells, a lane a row. Every lane gets the answer.
__device__ inline NearestPoint nearest_point(const PointGridView& grid, PointQ8 p, int lane) {
  NearestPoint nearest{p};
  for (int32_t number = 0;; ++number) {
    const CellRing ring(grid, {p, p}, number);
    const int32_t across = ring.to[1] - ring.from[1] + 1, rows = (ring.to[0] - ring.from[0] + 1) * across;
    for (int32_t row = lane; row < rows; row += 32)
      ring.visit_in_row(grid, ring.from[0] + row / across, ring.from[1] + row % across, nearest);
    warp_min_pair(nearest.distance_sq_q16, nearest.id);
    if (ring.reaches(nearest.bound_q16())) return nearest;
  }
}

}  // namespace attach_cooperative

template <>
struct CooperativeKernel<attach_seeds::AttachSeed> : CooperativeKernelOf<attach_seeds::AttachSeed> {
  struct Shared {};
  static __device__ void run(const attach_seeds::AttachSeed& step, int64_t i, Shared&, int lane) {
    const PointQ8 p = step.where_from(i);
    const uint32_t vertex = attach_cooperative::nearest_point(step.vertices, p, lane).id;
    if (lane != 0) return;
    step.home[i] = vertex;
    step.normal[i] = step.walk.normal[vertex];
    step.position[i] = step.walk.closest_around(vertex, p);
  }
};

}  // namespace isoshell
