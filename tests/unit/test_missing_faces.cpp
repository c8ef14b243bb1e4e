// Which large rims are what a missing piece of a flat face left, and which are meant to be open.
#include <algorithm>
#include <cmath>
#include <functional>

#include "isoshell/advanced/stages.h"
#include "isoshell/repair.h"
#include "support/catch.h"
#include "support/shapes.h"

using namespace isoshell;

namespace {

/// Triangles whose corners all are gone.
TriangleSoup without(TriangleSoup soup, const std::function<bool(WorldPoint)>& gone) {
  const auto is_gone = [&](const std::array<uint32_t, 3>& t) {
    return std::all_of(t.begin(), t.end(), [&](uint32_t v) { return gone(soup.vertices[v]); });
  };
  soup.triangles.erase(std::remove_if(soup.triangles.begin(), soup.triangles.end(), is_gone), soup.triangles.end());
  return soup;
}
TriangleSoup without_triangle(TriangleSoup soup, size_t t) {
  soup.triangles.erase(soup.triangles.begin() + int64_t(t));
  return soup;
}
TriangleSoup open_box(WorldPoint lo, WorldPoint hi) {
  return without(shapes::box(lo, hi), [=](WorldPoint p) { return p.z == hi.z; });
}
/// Walls along a polygon in the order of its corners, seen from above to the left; they look outward.
TriangleSoup walls(const std::vector<std::array<double, 2>>& corners, double height) {
  TriangleSoup soup;
  const auto n = uint32_t(corners.size());
  for (const auto& [x, y] : corners)
    for (const double z : {0., height}) soup.vertices.push_back({x, y, z});
  for (uint32_t i = 0; i < n; ++i) {
    const uint32_t a = 2 * i, b = 2 * ((i + 1) % n);
    shapes::add_triangle(soup, a, b, b + 1);
    shapes::add_triangle(soup, a, b + 1, a + 1);
  }
  return soup;
}
std::vector<std::array<double, 2>> round(double radius, int n) {
  std::vector<std::array<double, 2>> corners;
  for (int i = 0; i < n; ++i)
    corners.push_back({radius * std::cos(6.283185307179586 * i / n), radius * std::sin(6.283185307179586 * i / n)});
  return corners;
}
/// A surface between two polygons of as many corners at one height; it looks upward where the second is the inner one.
TriangleSoup ring(const std::vector<std::array<double, 2>>& outer, const std::vector<std::array<double, 2>>& inner,
                  double z) {
  TriangleSoup soup;
  const auto n = uint32_t(outer.size());
  for (uint32_t i = 0; i < n; ++i)
    for (const auto& [x, y] : {outer[i], inner[i]}) soup.vertices.push_back({x, y, z});
  for (uint32_t i = 0; i < n; ++i) {
    const uint32_t a = 2 * i, b = 2 * ((i + 1) % n);
    shapes::add_triangle(soup, a, b, b + 1);
    shapes::add_triangle(soup, a, b + 1, a + 1);
  }
  return soup;
}
const std::vector<std::array<double, 2>> kSquare = {{0, 0}, {3, 0}, {3, 3}, {0, 3}};
const std::vector<std::array<double, 2>> kInner = {{.2, .2}, {2.8, .2}, {2.8, 2.8}, {.2, 2.8}};

struct Repaired {
  TriangleSoup soup;
  RepairReport report;
  InputTopology topology;
};
Repaired repaired(const TriangleSoup& soup) {
  Repaired m;
  m.soup = repair_soup(soup, {}, m.report);
  Context context;
  m.topology = measure_topology(m.soup, context).topology;
  return m;
}

void check_solid(const TriangleSoup& soup, double expected) {
  const Repaired m = repaired(soup);
  CHECK(m.topology.closed);
  CHECK(m.topology.oriented);
  CHECK(m.topology.components == 1);
  CHECK(m.report.open_loops == 0);
  CHECK(std::abs(volume(m.soup) - expected) < 1e-9 * expected);
}

void check_open(const TriangleSoup& soup, int64_t loops) {
  const Repaired m = repaired(soup);
  CHECK_FALSE(m.report.changed_anything());
  CHECK(m.report.open_loops == loops);
}

}  // namespace

TEST_CASE("missing faces: a box that lacks any of its triangles is closed", "[repair]") {
  for (size_t t = 0; t < 12; ++t) check_solid(without_triangle(shapes::box({0, 0, 0}, {1, 2, 3}), t), 6);
}

TEST_CASE("missing faces: a face is closed around the pockets that hang on it", "[repair]") {
  TriangleSoup part = open_box({0, 0, 0}, {4, 4, 3});
  for (const WorldPoint& at : {WorldPoint{.5, .5, 1}, {2.5, .5, 2}, {.5, 2.5, 2.9}})
    part = shapes::together(part, shapes::inside_out(open_box(at, {at.x + 1, at.y + 1, 3})));
  check_solid(part, 48 - 2 - 1 - .1);
}

TEST_CASE("missing faces: what stands in a pocket and ends in the same plane has a face of its own", "[repair]") {
  const TriangleSoup body =
      shapes::together(open_box({0, 0, 0}, {6, 6, 3}), shapes::inside_out(open_box({1, 1, 1}, {5, 5, 3})));
  const Repaired m = repaired(shapes::together(body, open_box({2, 2, 1.5}, {4, 4, 3})));
  CHECK(m.topology.components == 2);
  CHECK(m.report.open_loops == 1);
  CHECK(m.report.capped_loops == 2);
}

TEST_CASE("missing faces: two walls of a cup are closed at their rims", "[repair]") {
  const auto outer = round(2, 40), inner = round(1.8, 40);
  check_solid(shapes::together(walls(outer, 1), shapes::inside_out(walls(inner, 1))),
              20 * std::sin(6.283185307179586 / 40) * (4 - 1.8 * 1.8));
}

TEST_CASE("missing faces: a box, a bowl, a tube, a room, a cake tin and a washer stay open", "[repair]") {
  const TriangleSoup room = shapes::inside_out(open_box({0, 0, 0}, {5, 5, 3}));
  const TriangleSoup pillar = open_box({2, 2, 2}, {3, 3, 3});
  check_open(open_box({0, 0, 0}, {3, 3, 2}), 1);
  check_open(room, 1);
  check_open(shapes::together(room, pillar), 2);
  check_open(without(shapes::sphere({0, 0, 0}, 1, 32), [](WorldPoint p) { return p.z > -1e-9; }), 1);
  check_open(walls(round(2, 40), 1), 2);
  const auto outer = round(2, 40), inner = round(1.8, 40);
  const TriangleSoup sides = shapes::together(walls(outer, 1), shapes::inside_out(walls(inner, 1)));
  check_open(shapes::together(sides, shapes::inside_out(ring(outer, inner, 0))), 2);
  check_open(ring(outer, inner, 0), 2);
}

TEST_CASE("missing faces: ducts, slots and the narrow side of a box stay", "[repair]") {
  const TriangleSoup box = shapes::box({0, 0, 0}, {10, 10, 1});
  check_open(without(box, [](WorldPoint p) { return p.x == 10; }), 1);
  check_open(without(without(box, [](WorldPoint p) { return p.x == 10; }), [](WorldPoint p) { return p.x == 0; }), 2);
}

TEST_CASE("missing faces: half a lid on a round pan stays half a lid", "[repair]") {
  for (const int n : {16, 32, 160}) {
    TriangleSoup pan = walls(round(1, n), .4);
    for (uint32_t i = 1; i + 1 < uint32_t(n); ++i) shapes::add_triangle(pan, 0, 2 * (i + 1), 2 * i);
    for (uint32_t i = 1; i < uint32_t(n) / 2; ++i) shapes::add_triangle(pan, 1, 2 * i + 1, 2 * i + 3);
    check_open(pan, 1);
  }
}

TEST_CASE("missing faces: a triangle that hangs on a solid by a corner gets no second side", "[repair]") {
  TriangleSoup flag = shapes::box({0, 0, 0}, {1, 1, 1});
  for (const WorldPoint& p : {WorldPoint{2, 1, 1}, {1, 2, 1}}) flag.vertices.push_back(p);
  shapes::add_triangle(flag, 7, 8, 9);
  check_open(flag, 1);
}

TEST_CASE("missing faces: openings with a straight edge or a lip stay", "[repair]") {
  TriangleSoup half_lid = open_box({0, 0, 0}, {2, 2, 2});
  const auto corner = uint32_t(half_lid.vertices.size());
  for (const WorldPoint& p : {WorldPoint{0, 1.2, 2}, {2, 1.2, 2}}) half_lid.vertices.push_back(p);
  for (const auto& [from, to, by] : {std::array<uint32_t, 3>{4, 6, corner}, {5, 7, corner + 1}})
    for (size_t t = half_lid.triangles.size(); t-- > 0;) {  // walls are divided where the lid ends
      auto& c = half_lid.triangles[t];
      for (size_t i = 0; i < 3; ++i) {
        const uint32_t a = c[i], b = c[(i + 1) % 3], other = c[(i + 2) % 3];
        if (std::min(a, b) != from || std::max(a, b) != to) continue;
        c = {a, by, other};
        half_lid.triangles.push_back({by, b, other});
        break;
      }
    }
  shapes::add_triangle(half_lid, 4, 5, corner + 1);
  shapes::add_triangle(half_lid, 4, corner + 1, corner);
  check_open(half_lid, 1);
  check_open(shapes::together(open_box({0, 0, 0}, {3, 3, 1}), ring(kSquare, kInner, 1)), 1);
}
