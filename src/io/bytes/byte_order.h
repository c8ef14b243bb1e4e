// Numbers as binary files hold them, on any machine.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

namespace isoshell {

/// Known when it is compiled.
inline bool host_is_big_endian() {
  const uint16_t one = 1;
  return *reinterpret_cast<const unsigned char*>(&one) == 0;
}

template <class T>
T load_number(const char* p, bool big_endian) {
  T value;
  std::memcpy(&value, p, sizeof value);
  if (big_endian == host_is_big_endian()) return value;
  char bytes[sizeof value];
  std::reverse_copy(p, p + sizeof value, bytes);
  std::memcpy(&value, bytes, sizeof value);
  return value;
}
template <class T>
T load_little_endian(const char* p) {
  return load_number<T>(p, false);
}

template <class T>
std::array<char, sizeof(T)> little_endian_bytes(T value) {
  std::array<char, sizeof(T)> bytes;
  std::memcpy(bytes.data(), &value, sizeof value);
  if (host_is_big_endian()) std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

}  // namespace isoshell
