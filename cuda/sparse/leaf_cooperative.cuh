// What cooperative kernels over leaves share: a warp a leaf, and its active voxels as a list.
#pragma once

#include "cuda/runtime/cooperative_kernel.cuh"
#include "voxel/leaf.h"

namespace isoshell::leaf_cooperative {

template <class Step, class SharedOfLeaf>
struct CooperativeLeaf : CooperativeKernelOf<Step> {
  using Shared = SharedOfLeaf;
};

struct Offsets {
  uint16_t offset[512];
};

/// Offsets of a leaf's active voxels, ascending, and how many there are.
__device__ inline int list_active(const LeafMask& mask, uint16_t* offsets, int lane) {
  int count = 0;
  for (int half = 0; half < 16; ++half) {
    const uint32_t bits = uint32_t(mask.word[half >> 1] >> (32 * (half & 1)));
    if (bits >> lane & 1) offsets[count + lanes_before(bits)] = uint16_t(half * 32 + lane);
    count += __popc(bits);
  }
  __syncwarp();
  return count;
}

}  // namespace isoshell::leaf_cooperative
