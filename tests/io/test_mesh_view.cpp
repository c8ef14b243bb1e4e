// Meshes in arrays of the caller: the surfaces that files of the same would give.
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "geometry/world_vector.h"
#include "isoshell/io/mesh_view.h"
#include "support/catch.h"
#include "support/refusals.h"
#include "support/shapes.h"

using namespace isoshell;

namespace {

/// As programs have vertices: positions in single precision among other things.
struct Vertex {
  float u, v;
  float position[3];
  uint8_t color[4];
};

std::vector<Vertex> vertices_of(const TriangleSoup& soup) {
  std::vector<Vertex> vertices;
  for (const WorldPoint& p : soup.vertices)
    vertices.push_back({-1, -2, {float(p.x), float(p.y), float(p.z)}, {1, 2, 3, 4}});
  return vertices;
}

template <class T>
std::vector<T> corners_of(const TriangleSoup& soup) {
  std::vector<T> corners;
  for (const auto& triangle : soup.triangles)
    for (const uint32_t corner : triangle) corners.push_back(T(corner));
  return corners;
}

template <class T>
RowsView rows_of(const std::vector<T>& numbers) {
  return rows_of_three(numbers.data(), int64_t(numbers.size()) / 3);
}

TriangleSoup box() { return shapes::box({0, 0, 0}, {1, 2, 4}); }

RowsView positions_of(const TriangleSoup& soup) {
  return rows_of_three(&soup.vertices[0].x, int64_t(soup.vertices.size()));
}

template <class T>
TriangleSoup with_corners_of_type(const TriangleSoup& soup) {
  const std::vector<T> corners = corners_of<T>(soup);
  return soup_of({positions_of(soup), rows_of(corners)}, "mine");
}

}  // namespace

TEST_CASE("mesh view: positions within larger structures are read by their stride", "[mesh_view]") {
  const TriangleSoup given = box();
  const std::vector<Vertex> vertices = vertices_of(given);
  const std::vector<uint32_t> corners = corners_of<uint32_t>(given);
  const TriangleSoup made = soup_of(
      {rows_of_three(vertices[0].position, int64_t(vertices.size()), sizeof(Vertex)), rows_of(corners)}, "mine");
  CHECK(made.vertices == given.vertices);
  CHECK(made.triangles == given.triangles);
  CHECK(made.faces_in_file == int64_t(given.triangles.size()));
}

TEST_CASE("mesh view: corners are whole numbers of any width", "[mesh_view]") {
  const TriangleSoup given = box();
  CHECK(with_corners_of_type<int8_t>(given).triangles == given.triangles);
  CHECK(with_corners_of_type<uint16_t>(given).triangles == given.triangles);
  CHECK(with_corners_of_type<int32_t>(given).triangles == given.triangles);
  CHECK(with_corners_of_type<long>(given).triangles == given.triangles);
  CHECK(with_corners_of_type<unsigned long long>(given).triangles == given.triangles);
}

TEST_CASE("mesh view: columns have a stride of their own, and numbers need no alignment", "[mesh_view]") {
  const TriangleSoup given = box();
  const int64_t count = int64_t(given.vertices.size());
  std::vector<std::byte> bytes(size_t(1 + 3 * 8 * count));  // all x from the last to the first, then all y, all z
  for (int64_t i = 0; i < count; ++i)
    for (int64_t j = 0; j < 3; ++j)
      std::memcpy(&bytes[size_t(1 + 8 * (j * count + count - 1 - i))], &given.vertices[size_t(i)].x + j, 8);
  const RowsView columns{&bytes[size_t(1 + 8 * (count - 1))], ElementType::f64, count, 3, -8, 8 * count};
  const std::vector<uint32_t> corners = corners_of<uint32_t>(given);
  CHECK(soup_of({columns, rows_of(corners)}, "mine").vertices == given.vertices);
}

TEST_CASE("mesh view: a corner that is no vertex is refused with place, value and limit", "[mesh_view]") {
  const TriangleSoup given = box();
  const auto refusal = [&](auto value) {
    std::vector<decltype(value)> corners = corners_of<decltype(value)>(given);
    corners[7] = value;
    return message_of(ErrorCode::unreadable_input, [&] { soup_of({positions_of(given), rows_of(corners)}, "mine"); });
  };
  const std::string limit = "; indices count from 0 and are below 8, the number of vertices";
  CHECK(refusal(int32_t(8)) == "mine: corners[2, 1] is 8" + limit);
  CHECK(refusal(int8_t(-1)) == "mine: corners[2, 1] is -1" + limit);
  CHECK(refusal(int64_t(1) << 32) == "mine: corners[2, 1] is 4294967296" + limit);
  CHECK(refusal(std::numeric_limits<uint64_t>::max()) == "mine: corners[2, 1] is 18446744073709551615" + limit);
}

TEST_CASE("mesh view: what is dirty is dropped and counted, as readers do", "[mesh_view]") {
  TriangleSoup given = box();
  given.vertices.push_back({0, std::numeric_limits<double>::quiet_NaN(), 0});
  given.triangles.push_back({0, 1, 8});
  given.triangles.push_back({2, 3, 3});
  const TriangleSoup made = with_corners_of_type<uint32_t>(given);
  CHECK(made.triangles == box().triangles);
  CHECK(made.dirt.nonfinite_vertices == 1);
  CHECK(made.dirt.dropped_faces_nonfinite == 1);
  CHECK(made.dirt.degenerate_faces == 1);
}

TEST_CASE("mesh view: a view that cannot be read is refused", "[mesh_view]") {
  const TriangleSoup given = box();
  const std::vector<uint32_t> corners = corners_of<uint32_t>(given);
  const std::vector<float> fractions(corners.begin(), corners.end());
  const auto refusal = [&](ErrorCode code, const MeshView& mesh) {
    return message_of(code, [&] { soup_of(mesh, "mine"); });
  };
  const RowsView positions = positions_of(given);
  CHECK(refusal(ErrorCode::usage, {positions, rows_of(fractions)}) ==
        "mine: corners must be whole numbers, such as int32 or int64, and is float32");
  RowsView pairs = rows_of(corners);
  pairs.columns = 2;
  CHECK(refusal(ErrorCode::usage, {positions, pairs}) == "mine: corners has 2 columns; give rows of three");
  RowsView nothing = positions;
  nothing.first = nullptr;
  CHECK(refusal(ErrorCode::usage, {nothing, rows_of(corners)}) ==
        "mine: positions has 8 rows at a null pointer; give their address");
  nothing.rows = -1;
  CHECK(refusal(ErrorCode::usage, {nothing, rows_of(corners)}) == "mine: positions has -1 rows; give 0 or more");
  CHECK(contains(refusal(ErrorCode::nothing_to_mesh, {positions, rows_of_three<int>(nullptr, 0)}),
                 "mine: holds 8 vertices and no face"));
}
