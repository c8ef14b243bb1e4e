// Cooperative kernel of attach_to_sheet: a warp a seed. Lanes share the vertices of the blocks around it; one then
// looks at the triangles of its vertex.
#pragma once

#include "cuda/runtime/cooperative_kernel.cuh"
#include "stages/relax/attach_seeds_body.h"

namespace isoshell {
namespace attach_cooperative {

/// NearestVertex of a warp, the same in all its lanes.
struct NearestOfWarp {
  NearestVertex nearest;
  int lane;
  __device__ int64_t bound_q16() const { return nearest.bound_q16(); }
  __device__ void operator()(const GridPoint& block) {
    if (!nearest.may_be_in(block.id)) return;
    const View<const int64_t>& first = nearest.grid.first;
    for (int64_t v = first[block.id] + lane; v < first[block.id + 1]; v += 32) nearest.consider(uint32_t(v));
    warp_min_pair(nearest.distance_sq_q16, nearest.id);
  }
};

}  // namespace attach_cooperative

template <>
struct CooperativeKernel<attach_seeds::AttachSeed> : CooperativeKernelOf<attach_seeds::AttachSeed> {
  struct Shared {};
  static __device__ void run(const attach_seeds::AttachSeed& step, int64_t i, Shared&, int lane) {
    const PointQ8 p = step.where_from(i);
    attach_cooperative::NearestOfWarp search{{step.vertices, p}, lane};
    visit_around(step.vertices.blocks, BoxQ8{p, p}, search);
    const uint32_t vertex = search.nearest.id;
    if (lane != 0) return;
    step.home[i] = vertex;
    step.normal[i] = step.walk.normal[vertex];
    step.position[i] = step.walk.closest_around(vertex, p);
  }
};

}  // namespace isoshell
