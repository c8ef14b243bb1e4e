// Large arrays of zeros that are written to here and there.
#pragma once

#include <cstdlib>
#include <new>
#include <type_traits>
#include <vector>

namespace isoshell {

/// Memory that is zero where it has not been written to; the system may give it page by page, as it is.
template <class T>
struct ZeroedAllocator {
  static_assert(std::is_trivial_v<T>);
  using value_type = T;

  ZeroedAllocator() = default;
  template <class Other>
  ZeroedAllocator(const ZeroedAllocator<Other>&) {}

  T* allocate(size_t count) {
    if (void* memory = std::calloc(count, sizeof(T))) return static_cast<T*>(memory);
    throw std::bad_alloc();
  }
  void deallocate(T* memory, size_t) { std::free(memory); }
  /// Of what has no value given: it is zero.
  void construct(T*) {}

  bool operator==(const ZeroedAllocator&) const { return true; }
  bool operator!=(const ZeroedAllocator&) const { return false; }
};

/// As it is made: what becomes longer later is not cleared.
template <class T>
using ZeroedVector = std::vector<T, ZeroedAllocator<T>>;

}  // namespace isoshell
