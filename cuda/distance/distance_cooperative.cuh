// Cooperative kernel of sum_distances: a block a chunk of places.
#pragma once

#include "cuda/runtime/cooperative_kernel.cuh"
#include "stages/distance/distance_body.h"

namespace isoshell {

/// The threads search, one of them adds in order.
template <>
struct CooperativeKernel<distance_steps::SumPlaces> : CooperativeKernelOf<distance_steps::SumPlaces, 128, 1> {
  using Step = distance_steps::SumPlaces;
  struct Shared {
    distance_steps::Found found[Step::kChunk];
  };
  static __device__ void run(const Step& step, int64_t chunk, Shared& shared, int lane) {
    const int64_t first = chunk * Step::kChunk;
    const int count = int(step.end(chunk) - first);
    for (int i = lane; i < count; i += kThreads) shared.found[i] = step.at(first + i);
    __syncthreads();
    if (lane != 0) return;
    DistanceSums sums;
    for (int i = 0; i < count; ++i) step.add(first + i, shared.found[i], sums);
    step.sums[chunk] = sums;
  }
};

}  // namespace isoshell
