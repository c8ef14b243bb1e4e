// Form of attach_to_sheet: a warp a seed. Lanes share the rows of cells around it; one then
// looks at the triangles of its vertex.
#pragma once

#include "cuda/block_form.cuh"
#include "stages/attach_seeds_body.h"

namespace isoshell {
namespace attach_forms {

/// nearest_point by a warp: visit_around's rings of cells, a lane a row. Every lane gets the answer.
__device__ inline NearestPoint nearest_point(const PointGridView& grid, PointQ8 p, int lane) {
  NearestPoint nearest{p};
  const int32_t q8[3] = {p.x, p.y, p.z};
  const int32_t middle[3] = {grid_coordinate(grid, p.x, 0), grid_coordinate(grid, p.y, 1),
                             grid_coordinate(grid, p.z, 2)};
  for (int32_t ring = 0;; ++ring) {
    int32_t from[3], to[3];
    bool whole = true;  // nothing lies beyond this ring
    int64_t gap = int64_t(1) << 40;
    for (int axis = 0; axis < 3; ++axis) {
      from[axis] = middle[axis] - ring;
      to[axis] = middle[axis] + ring;
      if (from[axis] <= 0) {
        from[axis] = 0;
      } else {
        const int64_t below = int64_t(q8[axis]) - (int64_t(from[axis]) << grid.shift);
        gap = below < gap ? below : gap;
        whole = false;
      }
      if (to[axis] >= grid.dims[axis] - 1) {
        to[axis] = grid.dims[axis] - 1;
      } else {
        const int64_t above = (int64_t(to[axis] + 1) << grid.shift) - 1 - q8[axis];
        gap = above < gap ? above : gap;
        whole = false;
      }
    }
    const int32_t across = to[1] - from[1] + 1, rows = (to[0] - from[0] + 1) * across;
    for (int32_t row = lane; row < rows; row += 32) {
      const int32_t cx = from[0] + row / across, cy = from[1] + row % across;
      const bool inner =
          cx > middle[0] - ring && cx < middle[0] + ring && cy > middle[1] - ring && cy < middle[1] + ring;
      if (!inner) {
        visit_row(grid, cx, cy, from[2], to[2], nearest);
        continue;
      }
      if (middle[2] - ring >= 0) visit_row(grid, cx, cy, middle[2] - ring, middle[2] - ring, nearest);
      if (middle[2] + ring < grid.dims[2]) visit_row(grid, cx, cy, middle[2] + ring, middle[2] + ring, nearest);
    }
    warp_min_pair(nearest.distance_sq_q16, nearest.id);
    if (whole || (gap >= 0 && gap * gap >= nearest.distance_sq_q16)) return nearest;
  }
}

}  // namespace attach_forms

template <>
struct BlockForm<attach_seeds::AttachSeed> {
  static constexpr int kThreads = 32;
  static constexpr int kElements = 4;
  struct Shared {};
  static __device__ void run(const attach_seeds::AttachSeed& step, int64_t i, Shared&, int lane) {
    const PointQ8 s = step.position[i];
    const PointQ8 p = {s.x << step.halvings, s.y << step.halvings, s.z << step.halvings};
    const uint32_t vertex = attach_forms::nearest_point(step.vertices, p, lane).id;
    if (lane != 0) return;
    step.home[i] = vertex;
    step.normal[i] = step.sheet.normal[vertex];
    step.position[i] = step.sheet.closest_around(vertex, p);
  }
};

}  // namespace isoshell
