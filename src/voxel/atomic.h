// Integer atomics for steps: results do not depend on the order in which they happen.
#pragma once

#include <cstdint>

#include "isoshell/advanced/host_device.h"

namespace isoshell {

template <class T>
ISOSHELL_HD inline void atomic_add(T& target, T value) {
#if defined(__CUDA_ARCH__)
  using Word = unsigned long long;
  if constexpr (sizeof(T) == 8)
    atomicAdd(reinterpret_cast<Word*>(&target), Word(value));
  else
    atomicAdd(&target, value);
#else
  __atomic_fetch_add(&target, value, __ATOMIC_RELAXED);
#endif
}

/// Lowers the target by one and returns the new value: hands out the places below an end, each once, in any order.
ISOSHELL_HD inline uint32_t atomic_take_one_below(uint32_t& target) {
#if defined(__CUDA_ARCH__)
  return atomicSub(&target, 1u) - 1;
#else
  return __atomic_sub_fetch(&target, 1u, __ATOMIC_RELAXED);
#endif
}

template <class T>
ISOSHELL_HD inline void atomic_or(T& target, T value) {
#if defined(__CUDA_ARCH__)
  using Word = unsigned long long;
  if constexpr (sizeof(T) == 8)
    atomicOr(reinterpret_cast<Word*>(&target), Word(value));
  else
    atomicOr(&target, value);
#else
  __atomic_fetch_or(&target, value, __ATOMIC_RELAXED);
#endif
}

/// Reads a value that other threads may change meanwhile.
template <class T>
ISOSHELL_HD inline T atomic_load(const T& target) {
#if defined(__CUDA_ARCH__)
  return *static_cast<const volatile T*>(&target);
#else
  return __atomic_load_n(&target, __ATOMIC_RELAXED);
#endif
}

/// Stores `value` if the target still holds `expected`; returns whether it did.
ISOSHELL_HD inline bool atomic_exchange_if(uint32_t& target, uint32_t expected, uint32_t value) {
#if defined(__CUDA_ARCH__)
  return atomicCAS(&target, expected, value) == expected;
#else
  return __atomic_compare_exchange_n(&target, &expected, value, false, __ATOMIC_RELAXED, __ATOMIC_RELAXED);
#endif
}

/// Returns the value before. Which caller gets which value depends on the schedule, so results must not.
template <class T>
ISOSHELL_HD inline T atomic_fetch_add(T& target, T value) {
#if defined(__CUDA_ARCH__)
  using Word = unsigned long long;
  if constexpr (sizeof(T) == 8)
    return T(atomicAdd(reinterpret_cast<Word*>(&target), Word(value)));
  else
    return atomicAdd(&target, value);
#else
  return __atomic_fetch_add(&target, value, __ATOMIC_RELAXED);
#endif
}

/// Returns true when this call lowered the value.
template <class T>
ISOSHELL_HD inline bool atomic_min(T& target, T value) {
#if defined(__CUDA_ARCH__)
  using Word = unsigned long long;
  if constexpr (sizeof(T) == 8)
    return T(atomicMin(reinterpret_cast<Word*>(&target), Word(value))) > value;  // unsigned values only
  else
    return atomicMin(&target, value) > value;
#else
  T seen = __atomic_load_n(&target, __ATOMIC_RELAXED);
  while (value < seen)
    if (__atomic_compare_exchange_n(&target, &seen, value, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) return true;
  return false;
#endif
}

template <class T>
ISOSHELL_HD inline bool atomic_max(T& target, T value) {
#if defined(__CUDA_ARCH__)
  using Word = unsigned long long;
  if constexpr (sizeof(T) == 8)
    return T(atomicMax(reinterpret_cast<Word*>(&target), Word(value))) < value;  // unsigned values only
  else
    return atomicMax(&target, value) < value;
#else
  T seen = __atomic_load_n(&target, __ATOMIC_RELAXED);
  while (value > seen)
    if (__atomic_compare_exchange_n(&target, &seen, value, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) return true;
  return false;
#endif
}

}  // namespace isoshell
