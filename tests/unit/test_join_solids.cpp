// join_solids: unions of closed parts as one mesh.
#include "isoshell/advanced/stages.h"
#include "repair/holes/plane_triangulation.h"
#include "repair/solids/join_solids.h"
#include "support/catch.h"
#include "support/shapes.h"

using namespace isoshell;
using shapes::box;
using shapes::together;

namespace {

void check_union(const TriangleSoup& parts, double volume, int64_t genus) {
  Context context;
  JoinReport report;
  const auto joined = repair::join_solids(parts, report, context);
  REQUIRE(joined);
  const InputTopology found = measure_topology(joined->soup, context).topology;
  CHECK(found.closed);
  CHECK(found.oriented);
  CHECK(found.components == 1);
  CHECK(found.genus == genus);
  CHECK(std::abs(isoshell::volume(joined->soup) - volume) < 1e-4 * volume);
}

}  // namespace

TEST_CASE("joined solids: the union of bars that cross has the volume of both less that of what they share",
          "[join_solids]") {
  check_union(together(box({0, 2, 0}, {6, 4, 2}), box({2, 0, .5}, {4, 6, 1.5})), 24 + 12 - 4, 0);
}

TEST_CASE("joined solids: a box on a part of another one's top becomes one solid with it", "[join_solids]") {
  check_union(together(box({0, 0, 0}, {4, 4, 1}), box({1, 1, 1}, {3, 3, 3})), 16 + 8, 0);
}

TEST_CASE("joined solids: walls in one plane leave nothing of the inner one", "[join_solids]") {
  check_union(together(box({0, 0, 0}, {4, 4, 1}), box({0, 0, 0}, {2, 4, 3})), 16 + 16, 0);
}

TEST_CASE("joined solids: four bars around a window bound a solid of genus 1", "[join_solids]") {
  const TriangleSoup across = together(box({0, 0, 0}, {6, 1, 1}), box({0, 5, 0}, {6, 6, 1}));
  const TriangleSoup along = together(box({.5, -1, .5}, {1.5, 7, 2}), box({4.5, -1, .5}, {5.5, 7, 2}));
  check_union(together(across, along), 2 * 6 + 2 * 12 - 4 * .5, 1);
}

TEST_CASE("joined solids: what lies apart is left alone", "[join_solids]") {
  const Context context;
  JoinReport report;
  CHECK_FALSE(repair::join_solids(together(box({0, 0, 0}, {1, 1, 1}), box({2, 0, 0}, {3, 1, 1})), report, context));
  CHECK(report.given_up.empty());
}

TEST_CASE("plane triangulation: a square with a line across is two triangles, and lines that cross are refused",
          "[join_solids]") {
  const std::vector<PlanePoint> square{{0, 0}, {9, 0}, {9, 9}, {0, 9}};
  std::vector<std::array<uint32_t, 2>> lines{{0, 1}, {1, 2}, {2, 3}, {3, 0}, {1, 3}};
  const auto triangles = triangulate_plane(square, lines);
  REQUIRE(triangles);
  CHECK(triangles->size() == 2);
  lines.push_back({0, 2});
  CHECK_FALSE(triangulate_plane(square, lines));
}
