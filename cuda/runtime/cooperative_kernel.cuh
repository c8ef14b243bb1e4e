// Steps whose elements are too large for one thread: how several threads share one. CudaKernels::CooperativeSteps
// lists them; a step that is not there runs on one thread an element. A cooperative kernel computes what the step's
// operator() computes: same definition, same bytes.
#pragma once

#include <cstdint>

#include "cuda/cuda_kernels.h"
#include "cuda/runtime/warp.cuh"
#include "isoshell/advanced/buffer.h"

namespace isoshell {

/// Specialised for every step that is listed, from CooperativeKernelOf:
///   struct Shared;                    // of an element
///   static __device__ void run(const Step& step, int64_t i, Shared& shared, int lane);
/// Threads of an element synchronise by sync_element<Kernel>(). A listed step does not compile without the
/// header of its kernel.
template <class Step>
struct CooperativeKernel;

/// What the kernel of a step begins with.
template <class Step, int kThreadsOfElement = 32, int kElementsOfBlock = 4>
struct CooperativeKernelOf {
  static_assert(CudaKernels::CooperativeSteps::has<Step>,
                "list the step in cuda/cuda_kernels.h: its cooperative kernel is not used else");
  static constexpr int kThreads = kThreadsOfElement;  ///< 32 or fewer (a power of two), or a whole block
  static constexpr int kElements = kElementsOfBlock;  ///< 1 where kThreads > 32
};

/// Lanes of the calling thread's group of `kThreads` within its warp.
template <int kThreads>
__device__ inline unsigned group_lanes() {
  static_assert(kThreads <= 32 && (kThreads & (kThreads - 1)) == 0, "groups divide a warp");
  if constexpr (kThreads == 32) return kWholeWarp;
  return ((1u << (kThreads & 31)) - 1) << (threadIdx.x & 31 & ~(kThreads - 1));
}

template <class Kernel>
__device__ inline void sync_element() {
  if constexpr (Kernel::kThreads <= 32)
    __syncwarp(group_lanes<Kernel::kThreads>());
  else
    __syncthreads();
}

template <class Step>
__global__ void __launch_bounds__(CooperativeKernel<Step>::kThreads* CooperativeKernel<Step>::kElements)
    run_cooperative_kernel(int64_t count, Step step) {
  using Kernel = CooperativeKernel<Step>;
  static_assert(Kernel::kThreads <= 32 || Kernel::kElements == 1, "a block synchronises as one");
  __shared__ typename Kernel::Shared shared[Kernel::kElements];
  const int slot = int(threadIdx.x) / Kernel::kThreads, lane = int(threadIdx.x) % Kernel::kThreads;
  for (int64_t i = int64_t(blockIdx.x) * Kernel::kElements + slot; i < count;
       i += int64_t(gridDim.x) * Kernel::kElements) {
    Kernel::run(step, i, shared[slot], lane);
    sync_element<Kernel>();
  }
}

template <class Step>
void launch_cooperative_kernel(int64_t count, const Step& step, cudaStream_t stream) {
  using Kernel = CooperativeKernel<Step>;
  const int64_t blocks = (count + Kernel::kElements - 1) / Kernel::kElements;
  constexpr int64_t kMaxBlocks = 1 << 20;
  run_cooperative_kernel<<<unsigned(blocks < kMaxBlocks ? blocks : kMaxBlocks), Kernel::kThreads * Kernel::kElements, 0,
                           stream>>>(count, step);
}

}  // namespace isoshell
