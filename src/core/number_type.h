// The C++ types of the numbers that files hold.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "isoshell/attribute.h"

namespace isoshell {

/// Calls visit(T()) with the C++ type.
template <class Visit>
auto with_type(NumberType type, Visit visit) {
  switch (type) {
    case NumberType::i8:
      return visit(int8_t());
    case NumberType::u8:
      return visit(uint8_t());
    case NumberType::i16:
      return visit(int16_t());
    case NumberType::u16:
      return visit(uint16_t());
    case NumberType::i32:
      return visit(int32_t());
    case NumberType::u32:
      return visit(uint32_t());
    case NumberType::f32:
      return visit(float());
    default:
      return visit(double());
  }
}

/// The number of type T nearest to a value. What is not a number gives the smallest integer.
template <class T>
T nearest_of(double value) {
  if constexpr (std::is_floating_point_v<T>) {
    return T(value);
  } else {
    constexpr double lowest = std::numeric_limits<T>::lowest(), largest = std::numeric_limits<T>::max();
    return value > lowest ? T(std::min(std::floor(value + 0.5), largest)) : T(lowest);
  }
}
inline double nearest_of(NumberType type, double value) {
  return with_type(type, [&](auto number) { return double(nearest_of<decltype(number)>(value)); });
}

}  // namespace isoshell
