// Polygons into triangles.
#include <cmath>

#include "io/faces/polygon_split.h"
#include "support/catch.h"
#include "voxel/random.h"

using namespace isoshell;

namespace {

using Triangles = std::vector<std::array<uint32_t, 3>>;

Triangles split(const std::vector<WorldPoint>& points, std::vector<uint32_t> corners) {
  Triangles out;
  PolygonSplitter splitter;
  splitter.split(points.data(), corners.data(), int64_t(corners.size()), out);
  return out;
}

std::vector<uint32_t> all_of(const std::vector<WorldPoint>& points) {
  std::vector<uint32_t> corners;
  for (uint32_t i = 0; i < points.size(); ++i) corners.push_back(i);
  return corners;
}

double doubled_area_xy(const std::vector<WorldPoint>& p, const std::array<uint32_t, 3>& t) {
  return (p[t[1]].x - p[t[0]].x) * (p[t[2]].y - p[t[0]].y) - (p[t[1]].y - p[t[0]].y) * (p[t[2]].x - p[t[0]].x);
}

// A star-shaped polygon in the plane z = 0, turning left.
std::vector<WorldPoint> star(uint32_t count, uint64_t seed) {
  std::vector<WorldPoint> points;
  for (uint32_t i = 0; i < count; ++i) {
    const double angle = 6.283185307179586 * i / count, radius = 1 + double(random_bits(seed, i) % 1000) / 100;
    points.push_back({radius * std::cos(angle), radius * std::sin(angle), 0});
  }
  return points;
}

double polygon_area_xy(const std::vector<WorldPoint>& p) {
  double area = 0;
  for (size_t i = 0, j = p.size() - 1; i < p.size(); j = i++) area += p[j].x * p[i].y - p[i].x * p[j].y;
  return area;
}

}  // namespace

TEST_CASE("polygon split: a convex quad is cut along its shorter diagonal, a square at its smallest index",
          "[polygon][unit]") {
  CHECK(split({{0, 0, 0}, {3, 0, 0}, {4, 1, 0}, {1, 1, 0}}, {0, 1, 2, 3}) == Triangles{{1, 2, 3}, {1, 3, 0}});
  CHECK(split({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {3, 0, 1, 2}) == Triangles{{0, 1, 2}, {0, 2, 3}});
}

TEST_CASE("polygon split: a quad with a notch is cut at the notch", "[polygon][unit]") {
  CHECK(split({{0, 0, 0}, {4, 0, 0}, {1, 1, 0}, {0, 4, 0}}, {0, 1, 2, 3}).size() == 2);
  for (const auto& t : split({{0, 0, 0}, {4, 0, 0}, {1, 1, 0}, {0, 4, 0}}, {0, 1, 2, 3}))
    CHECK((t[0] == 2 || t[1] == 2 || t[2] == 2));
}

TEST_CASE("polygon split: stars are covered exactly once, whichever corner comes first", "[polygon][unit]") {
  for (uint32_t count = 5; count < 60; ++count) {
    const std::vector<WorldPoint> points = star(count, count);
    std::vector<uint32_t> corners = all_of(points);
    const Triangles triangles = split(points, corners);
    REQUIRE(triangles.size() == count - 2);
    double area = 0;
    for (const auto& t : triangles) {
      CHECK(doubled_area_xy(points, t) > 0);
      area += doubled_area_xy(points, t);
    }
    CHECK(std::abs(area - polygon_area_xy(points)) < 1e-9 * area);
    std::rotate(corners.begin(), corners.begin() + count / 3, corners.end());
    CHECK(split(points, corners) == triangles);
  }
}

TEST_CASE("polygon split: a hole reached by a bridge stays open", "[polygon][unit]") {
  const std::vector<WorldPoint> points = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0},
                                          {1, 1, 0}, {1, 3, 0}, {3, 3, 0}, {3, 1, 0}};
  double area = 0;
  for (const auto& t : split(points, {0, 1, 2, 3, 0, 4, 5, 6, 7, 4})) {
    CHECK(doubled_area_xy(points, t) > 0);
    area += doubled_area_xy(points, t);
  }
  CHECK(area == 2 * (16 - 4));
}

TEST_CASE("polygon split: no area and crossing sides still give corner count minus two triangles", "[polygon][unit]") {
  CHECK(split({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}}, {1, 2, 3, 4, 0}) ==
        Triangles{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}});
  CHECK(split({{0, 0, 0}, {4, 4, 0}, {4, 0, 0}, {0, 4, 0}, {2, 9, 0}}, {0, 1, 2, 3, 4}).size() == 3);
  CHECK(split({{1e200, 0, 0}, {0, 1e200, 0}, {-1e200, 0, 0}, {0, -1e200, 0}}, {0, 1, 2, 3}).size() == 2);
}

TEST_CASE("polygon split: combs of many teeth are covered exactly once, whichever way they look", "[polygon][unit]") {
  std::vector<WorldPoint> comb{{0, 0, 0}};
  for (int i = 1; i < 63999; ++i) comb.push_back({double(i), i % 2 ? 1000. : 1., 0});
  comb.push_back({63999, 0, 0});
  std::vector<WorldPoint> lying;
  for (const WorldPoint& p : comb) lying.push_back({p.y, -p.x, 0});
  for (const std::vector<WorldPoint>& points : {comb, lying}) {
    const Triangles triangles = split(points, all_of(points));
    CHECK(triangles.size() == points.size() - 2);
    double area = 0;
    for (const auto& t : triangles) area += std::abs(doubled_area_xy(points, t));
    CHECK(area == std::abs(polygon_area_xy(points)));
  }
}

TEST_CASE("polygon split: a polygon of many corners takes no long time", "[polygon][unit]") {
  const std::vector<WorldPoint> points = star(20000, 3);
  CHECK(split(points, all_of(points)).size() == points.size() - 2);
}
