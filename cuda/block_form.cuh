// Steps whose elements are too large for one thread: how several threads share one. A step without a form here runs on
// one thread an element. A form computes what the step's operator() computes: same definition, same bytes.
#pragma once

#include <cstdint>

#include "isoshell/buffer.h"

namespace isoshell {

/// Specialise it for a step:
///   static constexpr int kThreads;    // an element: 32 or fewer (a power of two), or a whole block
///   static constexpr int kElements;   // of a block: 1 where kThreads > 32
///   struct Shared;                    // of an element
///   static __device__ void run(const Step& step, int64_t i, Shared& shared, int lane);
/// Threads of an element synchronise by sync_element<Form>().
template <class Step>
struct BlockForm {
  static constexpr int kThreads = 1;
};

/// Lanes of the calling thread's group of `kThreads` within its warp.
template <int kThreads>
__device__ inline unsigned group_lanes() {
  static_assert(kThreads <= 32 && (kThreads & (kThreads - 1)) == 0, "groups divide a warp");
  if constexpr (kThreads == 32) return 0xffffffffu;
  return ((1u << (kThreads & 31)) - 1) << (threadIdx.x & 31 & ~(kThreads - 1));
}

template <class Form>
__device__ inline void sync_element() {
  if constexpr (Form::kThreads <= 32)
    __syncwarp(group_lanes<Form::kThreads>());
  else
    __syncthreads();
}

template <class Step>
__global__ void __launch_bounds__(BlockForm<Step>::kThreads* BlockForm<Step>::kElements)
    run_block_form(int64_t count, Step step) {
  using Form = BlockForm<Step>;
  static_assert(Form::kThreads <= 32 || Form::kElements == 1, "a block synchronises as one");
  __shared__ typename Form::Shared shared[Form::kElements];
  const int slot = int(threadIdx.x) / Form::kThreads, lane = int(threadIdx.x) % Form::kThreads;
  for (int64_t i = int64_t(blockIdx.x) * Form::kElements + slot; i < count; i += int64_t(gridDim.x) * Form::kElements) {
    Form::run(step, i, shared[slot], lane);
    sync_element<Form>();
  }
}

template <class Step>
void launch_block_form(int64_t count, const Step& step, cudaStream_t stream) {
  using Form = BlockForm<Step>;
  const int64_t blocks = (count + Form::kElements - 1) / Form::kElements;
  constexpr int64_t kMaxBlocks = 1 << 20;
  run_block_form<<<unsigned(blocks < kMaxBlocks ? blocks : kMaxBlocks), Form::kThreads * Form::kElements, 0, stream>>>(
      count, step);
}

/// Warp-wide reductions; every lane gets the result. Shuffles, since the instructions for them need newer chips.
__device__ inline uint32_t warp_or(uint32_t value) {
  for (int step = 16; step > 0; step >>= 1) value |= __shfl_xor_sync(0xffffffffu, value, step);
  return value;
}
__device__ inline uint32_t warp_and(uint32_t value) { return ~warp_or(~value); }
template <class T>
__device__ inline T warp_sum(T value) {
  for (int step = 16; step > 0; step >>= 1) value += __shfl_xor_sync(0xffffffffu, value, step);
  return value;
}
/// Sum of the values of the lanes before.
__device__ inline uint32_t warp_sum_before(uint32_t value, int lane) {
  uint32_t sum = value;
  for (int step = 1; step < 32; step <<= 1) {
    const uint32_t before = __shfl_up_sync(0xffffffffu, sum, step);
    if (lane >= step) sum += before;
  }
  return sum - value;
}

}  // namespace isoshell
