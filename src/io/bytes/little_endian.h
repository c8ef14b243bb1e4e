// Numbers as binary files hold them: little-endian, on any machine.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace isoshell {

/// The unsigned integer of a number's size.
template <class T>
using BitsOf = std::conditional_t<
    sizeof(T) == 8, uint64_t,
    std::conditional_t<sizeof(T) == 4, uint32_t, std::conditional_t<sizeof(T) == 2, uint16_t, uint8_t>>>;

template <class T>
BitsOf<T> bits_of(T value) {
  static_assert(sizeof(BitsOf<T>) == sizeof(T), "a number of 1, 2, 4 or 8 bytes");
  BitsOf<T> bits;
  std::memcpy(&bits, &value, sizeof value);
  return bits;
}

template <class T>
T load_little_endian(const char* p) {
  using Bits = BitsOf<T>;
  Bits bits = 0;
  for (size_t i = 0; i < sizeof(T); ++i) bits = Bits(bits | Bits(static_cast<unsigned char>(p[i])) << 8 * i);
  T value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

/// Calls put(char) for each byte, in the order of the file.
template <class T, class Put>
void store_little_endian(T value, Put put) {
  const auto bits = bits_of(value);
  for (size_t i = 0; i < sizeof(T); ++i) put(char(bits >> 8 * i & 0xff));
}

}  // namespace isoshell
