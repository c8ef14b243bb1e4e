// Owner and borrower of flat arrays. Kernels see View only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "isoshell/advanced/host_device.h"

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
  /// `count` elements from `begin` on.
  ISOSHELL_HD View part(int64_t begin, int64_t count) const { return {data + begin, count}; }
  template <class U, class = std::enable_if_t<!std::is_const_v<T> && std::is_same_v<U, const T>>>
  ISOSHELL_HD operator View<U>() const {
    return {data, size};
  }
};

enum class MemorySpace { host, cuda };

/// Where the bytes of Buffers lie. A Memory outlives every Buffer that it serves.
class Memory {
 public:
  virtual MemorySpace space() const = 0;
  /// At least 64-byte aligned, not initialised; null for 0 bytes. Throws Error{out_of_memory}.
  virtual void* allocate(int64_t bytes) = 0;
  virtual void free(void* data, int64_t bytes) noexcept = 0;
  /// Returns when the bytes have arrived.
  virtual void copy_to_host(void* to, const void* from, int64_t bytes) = 0;

 protected:
  ~Memory() = default;
};
Memory& host_memory();

/// Whether every byte of T belongs to a member: copies and sorts read them all, and nothing writes padding. Types with
/// floating-point members, which the language's trait leaves out, specialise it.
template <class T>
constexpr bool kHasNoPadding = std::has_unique_object_representations_v<T> || std::is_floating_point_v<T>;

/// Owns an array of trivially copyable T in one memory space. Moves, never copies. Elements may be
/// reached from the host only in host memory: see to_host.h.
template <class T>
class Buffer {
 public:
  Buffer() = default;
  /// Array of `size` elements, not initialised.
  explicit Buffer(int64_t size, Memory& memory = host_memory())
      : data_(static_cast<T*>(memory.allocate(size * int64_t(sizeof(T))))),
        size_(size),
        room_(size),
        memory_(&memory) {}
  Buffer(Buffer&& other) noexcept { swap(other); }
  Buffer& operator=(Buffer&& other) noexcept {
    Buffer(std::move(other)).swap(*this);
    return *this;
  }
  ~Buffer() {
    if (data_) memory_->free(data_, room_ * int64_t(sizeof(T)));
  }

  int64_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  MemorySpace space() const { return memory().space(); }
  Memory& memory() const { return memory_ ? *memory_ : host_memory(); }
  int64_t size_bytes() const { return size_ * int64_t(sizeof(T)); }
  /// Keeps the first `size` elements, and the memory of all.
  void shorten(int64_t size) { size_ = size < size_ ? size : size_; }
  /// A copy in host memory.
  Buffer to_host() const {
    static_assert(kHasNoPadding<T>, "nothing writes padding: give it members");
    Buffer copy(size_);
    if (size_ > 0) memory_->copy_to_host(copy.data_, data_, size_bytes());
    return copy;
  }
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
    std::swap(room_, other.room_);
    std::swap(memory_, other.memory_);
  }

  T* data_ = nullptr;
  int64_t size_ = 0;
  int64_t room_ = 0;  ///< elements that were allocated
  Memory* memory_ = nullptr;
};

}  // namespace isoshell
