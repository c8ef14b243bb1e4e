// Triangles between points and lines of a plane.
#include "repair/holes/plane_triangulation.h"
#include "support/catch.h"

using namespace isoshell;

TEST_CASE("plane triangulation: a square with a line across is two triangles, and lines that cross are refused",
          "[plane_triangulation]") {
  const std::vector<PlanePoint> square{{0, 0}, {9, 0}, {9, 9}, {0, 9}};
  std::vector<std::array<uint32_t, 2>> lines{{0, 1}, {1, 2}, {2, 3}, {3, 0}, {1, 3}};
  const auto triangles = triangulate_plane(square, lines);
  REQUIRE(triangles);
  CHECK(triangles->size() == 2);
  lines.push_back({0, 2});
  CHECK_FALSE(triangulate_plane(square, lines));
}
