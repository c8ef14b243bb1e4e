// Reading little-endian values from memory in order, never past the end.
#pragma once

#include <cstring>
#include <string>

#include "isoshell/advanced/buffer.h"

namespace isoshell {

/// Throws Error{unreadable_input} about this file.
[[noreturn]] void throw_unreadable_vdb(const std::string& path, const std::string& what);

class VdbCursor {
 public:
  VdbCursor(const std::string& path, View<const char> bytes, int64_t at) : path_(path), bytes_(bytes), at_(at) {}

  int64_t at() const { return at_; }
  /// The next bytes; throws unreadable_input when fewer are left.
  const char* take(int64_t count, const char* what) {
    if (count < 0 || count > bytes_.size - at_)
      fail(std::string(what) + " needs " + std::to_string(count) + " bytes where " + std::to_string(bytes_.size - at_) +
           " are left");
    at_ += count;
    return bytes_.data + at_ - count;
  }
  template <class T>
  T value(const char* what) {
    T v;
    std::memcpy(&v, take(sizeof v, what), sizeof v);
    return v;
  }
  std::string text(const char* what) {
    const uint32_t length = value<uint32_t>(what);
    return std::string(take(length, what), length);
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw_unreadable_vdb(path_, "byte " + std::to_string(at_) + ": " + what + "; the file is truncated or damaged");
  }

 private:
  const std::string& path_;
  View<const char> bytes_;
  int64_t at_;
};

}  // namespace isoshell
