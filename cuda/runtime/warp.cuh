// What the lanes of a warp do together. All 32 lanes call these, and every lane gets the answer of its group: the warp,
// or `kLanes` neighbouring lanes of it (a power of two).
#pragma once

#include <cstdint>
#include <type_traits>

namespace isoshell {

constexpr unsigned kWholeWarp = 0xffffffffu;

namespace warp_words {

template <int kLanes, class T, class Combine>
__device__ inline T reduce(T value, Combine combine) {
  static_assert(kLanes <= 32 && (kLanes & (kLanes - 1)) == 0, "groups divide a warp");
#pragma unroll
  for (int step = kLanes / 2; step > 0; step >>= 1) value = combine(value, T(__shfl_xor_sync(kWholeWarp, value, step)));
  return value;
}

/// Chips from sm_80 on have an instruction for these.
template <int kLanes, class T>
constexpr bool kOneInstruction =
#if __CUDA_ARCH__ >= 800
    kLanes == 32 && (std::is_same_v<T, int32_t> || std::is_same_v<T, uint32_t>);
#else
    false;
#endif

}  // namespace warp_words

template <int kLanes = 32, class T>
__device__ inline T warp_sum(T value) {
  if constexpr (warp_words::kOneInstruction<kLanes, T>)
    return __reduce_add_sync(kWholeWarp, value);
  else
    return warp_words::reduce<kLanes>(value, [](T a, T b) { return T(a + b); });
}

template <int kLanes = 32, class T>
__device__ inline T warp_min(T value) {
  if constexpr (warp_words::kOneInstruction<kLanes, T>)
    return __reduce_min_sync(kWholeWarp, value);
  else
    return warp_words::reduce<kLanes>(value, [](T a, T b) { return b < a ? b : a; });
}

template <int kLanes = 32, class T>
__device__ inline T warp_max(T value) {
  if constexpr (warp_words::kOneInstruction<kLanes, T>)
    return __reduce_max_sync(kWholeWarp, value);
  else
    return warp_words::reduce<kLanes>(value, [](T a, T b) { return a < b ? b : a; });
}

template <int kLanes = 32, class T>
__device__ inline T warp_or(T value) {
  static_assert(std::is_unsigned_v<T>, "bits");
  if constexpr (warp_words::kOneInstruction<kLanes, T>)
    return __reduce_or_sync(kWholeWarp, value);
  else
    return warp_words::reduce<kLanes>(value, [](T a, T b) { return T(a | b); });
}

template <int kLanes = 32, class T>
__device__ inline T warp_and(T value) {
  return T(~warp_or<kLanes>(T(~value)));
}

/// Smallest (key, index).
template <int kLanes = 32, class Key, class Index>
__device__ inline void warp_min_pair(Key& key, Index& index) {
#pragma unroll
  for (int step = kLanes / 2; step > 0; step >>= 1) {
    const Key other = __shfl_xor_sync(kWholeWarp, key, step);
    const Index other_index = __shfl_xor_sync(kWholeWarp, index, step);
    if (other < key || (other == key && other_index < index)) key = other, index = other_index;
  }
}

/// Sum of the values of the group's lanes up to this one; the last lane's is the whole sum.
template <int kLanes = 32, class T>
__device__ inline T warp_sum_until(T value) {
  const int lane = int(threadIdx.x) & (kLanes - 1);
#pragma unroll
  for (int step = 1; step < kLanes; step <<= 1) {
    const T before = __shfl_up_sync(kWholeWarp, value, step, kLanes);
    if (lane >= step) value += before;
  }
  return value;
}

/// Sum of the values of the group's lanes before this one.
template <int kLanes = 32, class T>
__device__ inline T warp_sum_before(T value) {
  return T(warp_sum_until<kLanes>(value) - value);
}

/// How many of the lanes before this one `lanes` names.
__device__ inline int lanes_before(unsigned lanes) { return __popc(lanes & ((1u << (threadIdx.x & 31)) - 1)); }

}  // namespace isoshell
