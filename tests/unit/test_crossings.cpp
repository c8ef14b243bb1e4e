// crossing_pairs against a look at every two triangles.
#include <random>

#include "measure/crossings.h"
#include "support/catch.h"
#include "voxel/intersect.h"

using namespace isoshell;

TEST_CASE("pairs of triangles that intersect are those that a look at every two finds") {
  const std::atomic<bool> never{false};
  size_t all = 0;
  for (uint32_t number = 0; number < 60; ++number) {
    std::mt19937 random(number);
    // Places that coincide, triangles without area, and triangles that share corners, edges or all three.
    const uint32_t vertices = 12 + number * 3, size = number % 2 == 0 ? 6 : 40, triangles = 3 * vertices;
    std::vector<PointQ8> position;
    std::vector<TriangleIndices> triangle;
    const auto below = [&](uint32_t n) { return random() % n; };
    for (uint32_t v = 0; v < vertices; ++v)
      position.push_back({int32_t(below(size)), int32_t(below(size)), int32_t(below(number % 3 == 0 ? 1 : size))});
    while (triangle.size() < triangles) {
      const uint32_t a = below(vertices), b = (a + 1 + below(5)) % vertices, c = (b + 1 + below(5)) % vertices;
      if (a != b && b != c && c != a) triangle.push_back({a, b, c});
    }
    std::vector<std::array<uint32_t, 2>> expected;
    const auto corners = [&](uint32_t t) {
      const auto& [a, b, c] = triangle[t];
      return CornersOfTriangle{{a, b, c}, {position[a], position[b], position[c]}};
    };
    for (uint32_t s = 0; s < triangles; ++s)
      for (uint32_t t = s + 1; t < triangles; ++t)
        if (triangles_intersect(corners(s), corners(t))) expected.push_back({s, t});
    all += expected.size();
    INFO("mesh " << number);
    CHECK(crossing_pairs({position.data(), int64_t(vertices)}, {triangle.data(), int64_t(triangles)}, {}, never) ==
          expected);
  }
  CHECK(all > 1000);
}
