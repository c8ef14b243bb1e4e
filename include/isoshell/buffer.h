// Owner and borrower of flat arrays. Kernels see View only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>

#include "isoshell/host_device.h"

namespace isoshell {

/// Pointer and length, trivially copyable; owns nothing.
template <class T>
struct View {
  T* data = nullptr;
  int64_t size = 0;

  ISOSHELL_HD T& operator[](int64_t i) const { return data[i]; }
  ISOSHELL_HD T* begin() const { return data; }
  ISOSHELL_HD T* end() const { return data + size; }
  ISOSHELL_HD bool empty() const { return size == 0; }
  ISOSHELL_HD operator View<const T>() const { return {data, size}; }
};

enum class MemorySpace { host, cuda };

/// Raw host memory, 64-byte aligned and not initialised. Throws Error{out_of_memory}; counted in
/// host_memory_peak_bytes().
void* allocate_host(int64_t bytes);
void free_host(void* data, int64_t bytes);

/// Largest number of bytes that host Buffers held at one time since the last reset.
int64_t host_memory_peak_bytes();
void reset_host_memory_peak();

/// Owns an array of trivially copyable T in one memory space. Moves, never copies.
template <class T>
class Buffer {
 public:
  using Free = void (*)(void* data, int64_t bytes);

  Buffer() = default;
  /// Host array of `size` elements, not initialised.
  explicit Buffer(int64_t size)
      : Buffer(static_cast<T*>(allocate_host(size * int64_t(sizeof(T)))), size, MemorySpace::host, free_host) {}
  Buffer(T* data, int64_t size, MemorySpace space, Free free) : data_(data), size_(size), space_(space), free_(free) {}
  Buffer(Buffer&& other) noexcept { swap(other); }
  Buffer& operator=(Buffer&& other) noexcept {
    Buffer(std::move(other)).swap(*this);
    return *this;
  }
  ~Buffer() {
    if (data_) free_(data_, size_ * int64_t(sizeof(T)));
  }

  int64_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  MemorySpace space() const { return space_; }
  int64_t size_bytes() const { return size_ * int64_t(sizeof(T)); }
  T* data() { return data_; }
  const T* data() const { return data_; }
  View<T> view() { return {data_, size_}; }
  View<const T> view() const { return {data_, size_}; }
  T& operator[](int64_t i) { return data_[i]; }
  const T& operator[](int64_t i) const { return data_[i]; }
  T* begin() { return data_; }
  T* end() { return data_ + size_; }
  const T* begin() const { return data_; }
  const T* end() const { return data_ + size_; }

 private:
  void swap(Buffer& other) {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    std::swap(space_, other.space_);
    std::swap(free_, other.free_);
  }

  T* data_ = nullptr;
  int64_t size_ = 0;
  MemorySpace space_ = MemorySpace::host;
  Free free_ = nullptr;
};

}  // namespace isoshell
