// The executor's words that give a number to the host, for few elements: one block, which writes the number straight
// into pinned memory. A launch and a wait instead of several launches, a copy and a wait: most calls of a run are
// small.
#pragma once

#include <cstdint>

#include "cuda/runtime/host_bell.cuh"
#include "cuda/runtime/warp.cuh"
#include "isoshell/buffer.h"

namespace isoshell::small_words {

constexpr int kThreads = 1024;
constexpr int kPerThread = 16;
constexpr int64_t kMost = int64_t(kThreads) * kPerThread;  ///< elements

/// Sum of the values of the threads before; `total` gets the sum of all. Every thread of a block of kThreads calls it.
template <class T>
__device__ inline T block_sum_before(T value, T& total) {
  __shared__ T of_warp[32];
  const int lane = int(threadIdx.x) & 31, warp = int(threadIdx.x) >> 5;
  const T sum = warp_sum_until(value);
  if (lane == 31) of_warp[warp] = sum;
  __syncthreads();
  if (warp == 0) of_warp[lane] = warp_sum_until(of_warp[lane]);
  __syncthreads();
  total = of_warp[31];
  const T before = (warp > 0 ? of_warp[warp - 1] : T(0)) + sum - value;
  __syncthreads();
  return before;
}

template <class T>
__device__ inline void give(T* to, T number, const HostBell& bell) {
  *to = number;
  ring(bell);
}

template <class T>
__global__ void give_sum(const T* a, const T* b, T* to, HostBell bell) {
  give(to, T(*a + *b), bell);
}

template <class T>
__global__ void __launch_bounds__(kThreads) exclusive_scan(View<T> counts, T* total, HostBell bell) {
  T own = 0, value[kPerThread], all;
  const int64_t begin = int64_t(threadIdx.x) * kPerThread;
#pragma unroll
  for (int k = 0; k < kPerThread; ++k) {
    value[k] = begin + k < counts.size ? counts[begin + k] : T(0);
    own += value[k];
  }
  T at = block_sum_before(own, all);
#pragma unroll
  for (int k = 0; k < kPerThread; ++k) {
    if (begin + k < counts.size) counts[begin + k] = at;
    at += value[k];
  }
  if (threadIdx.x == 0) give(total, all, bell);
}

/// Element k * kThreads + thread is the thread's k-th, so that the reads of a warp lie together.
template <class Keep>
__global__ void __launch_bounds__(kThreads)
    select(int64_t count, Keep keep, uint32_t* out, uint32_t* total, HostBell bell) {
  __shared__ uint32_t before[kThreads];  // of word 32 k + warp
  const int lane = int(threadIdx.x) & 31, warp = int(threadIdx.x) >> 5;
  before[threadIdx.x] = 0;
  __syncthreads();
  uint32_t kept = 0;
#pragma unroll
  for (int k = 0; k < kPerThread; ++k) {
    const int64_t i = int64_t(k) * kThreads + threadIdx.x;
    if (i - lane >= count) break;
    const bool in = i < count && bool(keep(i));
    kept |= uint32_t(in) << k;
    const uint32_t word = __ballot_sync(kWholeWarp, in);
    if (lane == 0) before[32 * k + warp] = uint32_t(__popc(word));
  }
  __syncthreads();
  uint32_t all;
  const uint32_t words_before = block_sum_before(before[threadIdx.x], all);
  before[threadIdx.x] = words_before;
  __syncthreads();
#pragma unroll
  for (int k = 0; k < kPerThread; ++k) {
    const bool in = kept >> k & 1;
    const uint32_t word = __ballot_sync(kWholeWarp, in);
    if (in) out[before[32 * k + warp] + lanes_before(word)] = uint32_t(k * kThreads + threadIdx.x);
  }
  if (threadIdx.x == 0) give(total, all, bell);
}

/// The numbers of the bits that are set, ascending; a word a thread.
template <class Word>
__global__ void __launch_bounds__(kThreads)
    list_bits(View<const Word> words, uint32_t* out, uint32_t* total, HostBell bell) {
  uint32_t word = int64_t(threadIdx.x) < words.size ? words[threadIdx.x] : 0, all;
  uint32_t at = block_sum_before(uint32_t(__popc(word)), all);
  for (; word; word &= word - 1) out[at++] = 32 * threadIdx.x + uint32_t(__ffs(int(word))) - 1;
  if (threadIdx.x == 0) give(total, all, bell);
}

template <class Term>
__global__ void __launch_bounds__(kThreads) sum(int64_t count, Term term, int64_t* total, HostBell bell) {
  int64_t own = 0, all;
  for (int64_t i = threadIdx.x; i < count; i += kThreads) own += int64_t(term(i));
  block_sum_before(own, all);
  if (threadIdx.x == 0) give(total, all, bell);
}

}  // namespace isoshell::small_words
