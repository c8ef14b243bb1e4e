#include "isoshell/io/mesh_view.h"

#include <cstddef>
#include <cstring>
#include <utility>

#include "io/faces/face_collector.h"
#include "isoshell/error.h"

namespace isoshell {
namespace {

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::usage, "arguments", message); }

/// Calls visit(T()) with the C++ type.
template <class Visit>
void with_type(ElementType type, Visit visit) {
  switch (type) {
    case ElementType::i8:
      return visit(int8_t());
    case ElementType::u8:
      return visit(uint8_t());
    case ElementType::i16:
      return visit(int16_t());
    case ElementType::u16:
      return visit(uint16_t());
    case ElementType::i32:
      return visit(int32_t());
    case ElementType::u32:
      return visit(uint32_t());
    case ElementType::i64:
      return visit(int64_t());
    case ElementType::u64:
      return visit(uint64_t());
    case ElementType::f32:
      return visit(float());
    case ElementType::f64:
      return visit(double());
  }
}

/// Calls visit(i, value) for every value, row by row.
template <class T, class Visit>
void each_value(const RowsView& rows, Visit visit) {
  const auto* const bytes = static_cast<const std::byte*>(rows.first);
  for (int64_t i = 0; i < rows.rows; ++i)
    for (int64_t j = 0; j < rows.columns; ++j) {
      T value;
      std::memcpy(&value, bytes + i * rows.row_stride_bytes + j * rows.column_stride_bytes, sizeof(T));
      visit(i * rows.columns + j, value);
    }
}

void check_rows(const RowsView& rows, const std::string& name) {
  const auto refuse_count = [&](int64_t count, const char* what, const std::string& limit) {
    refuse(name + " has " + std::to_string(count) + " " + what + "; " + limit);
  };
  if (rows.rows < 0) refuse_count(rows.rows, "rows", "give 0 or more");
  if (rows.columns < 0) refuse_count(rows.columns, "columns", "give 0 or more");
  if (!rows.first && rows.rows > 0) refuse_count(rows.rows, "rows at a null pointer", "give their address");
}

void check_rows_of_three(const RowsView& rows, const std::string& name) {
  check_rows(rows, name);
  if (rows.columns != 3) refuse(name + " has " + std::to_string(rows.columns) + " columns; give rows of three");
}

[[noreturn]] void refuse_index(const RowsView& rows, const std::string& name, int64_t at, const std::string& value,
                               int64_t vertices) {
  std::string place = std::to_string(at / rows.columns);
  if (rows.columns > 1) place += ", " + std::to_string(at % rows.columns);
  throw Error(ErrorCode::unreadable_input, "arguments",
              name + "[" + place + "] is " + value + "; indices count from 0 and are below " +
                  std::to_string(vertices) + ", the number of vertices");
}

template <class T>
bool is_index(T value, int64_t vertices) {
  if constexpr (std::is_signed_v<T>)
    if (value < 0) return false;
  return uint64_t(value) < uint64_t(vertices);
}

void copy_indices(const RowsView& rows, int64_t vertices, const std::string& name, uint32_t* to) {
  with_type(rows.type, [&](auto zero) {
    using T = decltype(zero);
    if constexpr (std::is_floating_point_v<T>)
      refuse(name + " must be whole numbers, such as int32 or int64, and is float" + std::to_string(8 * sizeof(T)));
    else
      each_value<T>(rows, [&](int64_t at, T value) {
        if (!is_index(value, vertices)) refuse_index(rows, name, at, std::to_string(value), vertices);
        to[at] = uint32_t(value);
      });
  });
}

}  // namespace

std::vector<WorldPoint> points_in(const RowsView& rows, const std::string& name) {
  check_rows_of_three(rows, name);
  std::vector<WorldPoint> points(size_t(rows.rows));
  static_assert(sizeof(WorldPoint) == 3 * sizeof(double), "three numbers, one after the other");
  double* const to = points.empty() ? nullptr : &points[0].x;
  with_type(rows.type, [&](auto zero) {
    using T = decltype(zero);
    each_value<T>(rows, [&](int64_t at, T value) { to[at] = double(value); });
  });
  return points;
}

std::vector<uint32_t> indices_in(const RowsView& rows, int64_t vertices, const std::string& name) {
  check_rows(rows, name);
  std::vector<uint32_t> indices(size_t(rows.rows * rows.columns));
  copy_indices(rows, vertices, name, indices.data());
  return indices;
}

std::vector<std::array<uint32_t, 3>> triangles_in(const RowsView& rows, int64_t vertices, const std::string& name) {
  check_rows_of_three(rows, name);
  std::vector<std::array<uint32_t, 3>> triangles(size_t(rows.rows));
  copy_indices(rows, vertices, name, triangles.empty() ? nullptr : triangles[0].data());
  return triangles;
}

TriangleSoup soup_of(const MeshView& mesh, const std::string& name) {
  const MeshSource source(name, {});
  std::vector<WorldPoint> points = points_in(mesh.positions, name + ": positions");
  VertexTable vertices(source, int64_t(points.size()));
  vertices.points = std::move(points);
  vertices.count_nonfinite();
  std::vector<FaceCollector> parts(1, FaceCollector(vertices));
  parts[0].adopt(triangles_in(mesh.corners, mesh.positions.rows, name + ": corners"));
  return join_soup(source, std::move(vertices), parts);
}

}  // namespace isoshell
