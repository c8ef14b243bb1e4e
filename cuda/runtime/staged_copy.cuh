// Copies to shared memory that go on while the warp does something else.
#pragma once

#include <cuda_pipeline_primitives.h>

namespace isoshell::cuda_relax {

/// Starts to copy an array to shared memory, in steps of 16 bytes, up to 15 bytes more than it has. All lanes call it.
template <class T>
__device__ inline void start_copy(T* to, const T* from, int count) {
  const int bytes = count * int(sizeof(T));
#pragma unroll 1
  for (int at = 16 * int(threadIdx.x & 31); at < bytes; at += 32 * 16)
    __pipeline_memcpy_async(reinterpret_cast<char*>(to) + at, reinterpret_cast<const char*>(from) + at, 16);
}
__device__ inline void wait_for_copies() {
  __pipeline_commit();
  __pipeline_wait_prior(0);
  __syncwarp();
}

/// An element of an array of 8-byte elements whose first `staged` ones are in shared memory.
template <class T>
__device__ inline T element_of(const T* here, int staged, const T* all, int i) {
  static_assert(sizeof(T) == 8, "one load");
  if (i < staged) return here[i];
  const uint2 words = __ldg(reinterpret_cast<const uint2*>(all) + i);
  return reinterpret_cast<const T&>(words);
}

}  // namespace isoshell::cuda_relax
