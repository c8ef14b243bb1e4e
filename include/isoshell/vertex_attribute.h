// What stands at the vertices of a surface beside their positions: colours, and any other numbers.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace isoshell {

/// How a file holds a number.
enum class NumberType { i8, u8, i16, u16, i32, u32, f32, f64 };

/// Name of the attribute that is a colour: red, green, blue and possibly alpha. Integers are parts of the largest value
/// of their type.
constexpr const char* kColorName = "color";

struct VertexAttribute {
  std::string name;
  NumberType type = NumberType::f32;
  int32_t components = 1;
  std::vector<double> values;  ///< `components` of them a vertex, in the order of the vertices
};

/// What a file has at its vertices and the result has not.
struct DroppedAttribute {
  std::string name, reason;
};

}  // namespace isoshell
