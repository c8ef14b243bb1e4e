// Cooperative kernel of measure_topology's sum of areas: a block a run of faces.
#pragma once

#include "cuda/runtime/cooperative_kernel.cuh"
#include "stages/surface/topology_body.h"

namespace isoshell {

/// The threads measure the faces, one of them adds in order.
template <>
struct CooperativeKernel<topology_steps::AddAreas> : CooperativeKernelOf<topology_steps::AddAreas, 256, 1> {
  using Step = topology_steps::AddAreas;
  struct Shared {
    double area[Step::kChunk];
  };
  static __device__ void run(const Step& step, int64_t chunk, Shared& shared, int lane) {
    const int64_t first = chunk * Step::kChunk;
    const int count = int(step.end(chunk) - first);
    for (int f = lane; f < count; f += kThreads) shared.area[f] = step.area(first + f);
    __syncthreads();
    if (lane != 0) return;
    double sum = 0;
    for (int f = 0; f < count; ++f) sum += shared.area[f];
    step.part[chunk] = sum;
  }
};

}  // namespace isoshell
