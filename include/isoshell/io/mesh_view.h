// A mesh that a program has in arrays of its own, of whatever numbers and strides.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

#include "isoshell/surface_source.h"

namespace isoshell {

/// What a number in memory is.
enum class ElementType { i8, u8, i16, u16, i32, u32, i64, u64, f32, f64 };

template <class T>
constexpr ElementType element_type_of() {
  static_assert(std::is_arithmetic_v<T> && !std::is_same_v<T, bool> && sizeof(T) <= 8, "of 8, 16, 32 or 64 bits");
  if constexpr (std::is_floating_point_v<T>)
    return sizeof(T) == 4 ? ElementType::f32 : ElementType::f64;
  else if constexpr (sizeof(T) == 1)
    return std::is_signed_v<T> ? ElementType::i8 : ElementType::u8;
  else if constexpr (sizeof(T) == 2)
    return std::is_signed_v<T> ? ElementType::i16 : ElementType::u16;
  else if constexpr (sizeof(T) == 4)
    return std::is_signed_v<T> ? ElementType::i32 : ElementType::u32;
  else
    return std::is_signed_v<T> ? ElementType::i64 : ElementType::u64;
}

/// Rows of numbers. Borrows them; they need not be aligned, and strides may be below 0.
struct RowsView {
  const void* first = nullptr;
  ElementType type = ElementType::f64;
  int64_t rows = 0, columns = 3;
  int64_t row_stride_bytes = 0;     ///< from one row to the next
  int64_t column_stride_bytes = 0;  ///< from one number of a row to the next
};

/// Rows of three numbers side by side: `row_stride_bytes` is more where they are part of larger structures.
template <class T>
RowsView rows_of_three(const T* first, int64_t rows, int64_t row_stride_bytes = 3 * sizeof(T)) {
  return {first, element_type_of<T>(), rows, 3, row_stride_bytes, sizeof(T)};
}

/// Triangles in memory of the caller, which is borrowed.
struct MeshView {
  RowsView positions;  ///< world units, a row a vertex
  RowsView corners;    ///< whole numbers, a row a triangle: its vertices, from 0 on
};

/// The triangles that readers of mesh files make of the same faces: those that repeat a corner or have a position that
/// is not finite are dropped and counted in the result. Cost: one copy. Throws: unreadable_input, naming the place, the
/// value and the limit, for a corner that is no vertex; nothing_to_mesh without a usable triangle; usage for numbers of
/// another kind, for another number of columns than three, and for a view of nothing that says to have rows. `name` is
/// what messages call the mesh.
TriangleSoup soup_of(const MeshView& mesh, const std::string& name);

/// Rows of three numbers, as they are; `name` is what messages call the array. Throws: usage, as soup_of does.
std::vector<WorldPoint> points_in(const RowsView& rows, const std::string& name);

/// Whole numbers row by row, each at least 0 and below `vertices`. Throws: usage and unreadable_input, as soup_of does.
std::vector<uint32_t> indices_in(const RowsView& rows, int64_t vertices, const std::string& name);

/// The same in rows of three.
std::vector<std::array<uint32_t, 3>> triangles_in(const RowsView& rows, int64_t vertices, const std::string& name);

}  // namespace isoshell
