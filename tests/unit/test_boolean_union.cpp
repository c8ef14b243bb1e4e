// unite, and the rays that it counts windings with.
#include <cmath>

#include "isoshell/boolean_union.h"
#include "isoshell/error.h"
#include "repair/solids/winding.h"
#include "support/catch.h"
#include "support/shapes.h"

using namespace isoshell;
using shapes::inside_out;
using shapes::together;

namespace {

struct United {
  TriangleSoup soup;
  UnionReport report;
};

United united(const TriangleSoup& soup, bool outer_only = false, double finest_edge = .01) {
  United u;
  const Context context;
  u.soup = boolean_union(soup, {outer_only, finest_edge}, u.report, context);
  return u;
}

TriangleSoup ball(double radius, double x = 0) { return shapes::sphere({x, 0, 0}, radius, 24); }

int winding_at(const TriangleSoup& soup, const WorldPoint& p) {
  int number = 0;
  RayColumns(soup.vertices, soup.triangles).for_each_crossing(p, 0xffffffffu, [&](uint32_t, int sign) {
    number += sign;
  });
  return number;
}

}  // namespace

TEST_CASE("winding: numbers are those of a torus and a box, at random points and on lines through corners",
          "[boolean_union]") {
  const TriangleSoup ring = shapes::torus(2, .5, 48, 24), box = shapes::box({0, 0, 0}, {4, 4, 4});
  int inside = 0;
  for (uint64_t i = 0; i < 3000; ++i) {
    const auto coordinate = [&](uint64_t axis) { return double(random_bits(axis, i) % 6001) / 1000 - 3; };
    const WorldPoint p = {coordinate(1), coordinate(2), coordinate(3) / 4};
    const double from_tube = std::hypot(std::hypot(p.x, p.y) - 2, p.z);
    if (std::abs(from_tube - .5) > .02) {
      CHECK(winding_at(ring, p) == int(from_tube < .5));
      inside += from_tube < .5;
    }
  }
  CHECK(inside > 300);
  for (int x = -1; x <= 4; ++x)  // rays along edges and diagonals of the box
    for (int y = -1; y <= 4; ++y)
      for (int z = -1; z <= 4; ++z)
        if (const bool within = x > 0 && y > 0 && z > 0 && x < 4 && y < 4 && z < 4; within || x < 0 || y < 0 || z < 0)
          CHECK(winding_at(box, {double(x), double(y), double(z)}) == int(within));
}

TEST_CASE("boolean union: what lies apart comes back as it is", "[boolean_union]") {
  const TriangleSoup apart = together(ball(1), ball(1, 2.5));
  const United u = united(apart);
  CHECK_FALSE(u.report.changed_anything());
  CHECK(u.soup.vertices.size() == apart.vertices.size());
  CHECK(u.soup.triangles == apart.triangles);
}

TEST_CASE("boolean union: a ball in a ball is swallowed, one turned inward bounds a hollow", "[boolean_union]") {
  const United swallowed = united(together(ball(1), ball(.5)));
  CHECK(swallowed.report.swallowed_components == 1);
  CHECK(volume(swallowed.soup) == Approx(volume(ball(1))));
  const TriangleSoup hollow = together(ball(1), inside_out(ball(.5)));
  const United kept = united(hollow);
  CHECK(kept.report.inner_surfaces == 1);
  CHECK_FALSE(kept.report.changed_anything());
  const United outer = united(hollow, true);
  CHECK(outer.report.dropped_inner == 1);
  CHECK(volume(outer.soup) == Approx(volume(ball(1))));
}

TEST_CASE("boolean union: three balls in each other, turned in and out, all stay; turned inward in a hollow, one goes",
          "[boolean_union]") {
  const TriangleSoup hollow = together(ball(1), inside_out(ball(.7)));
  const United nested = united(together(hollow, ball(.4)));
  CHECK_FALSE(nested.report.changed_anything());
  CHECK(nested.report.inner_surfaces == 1);
  CHECK(united(together(hollow, ball(.4)), true).report.dropped_inner == 2);
  CHECK(united(together(hollow, inside_out(ball(.4)))).report.swallowed_components == 1);
}

TEST_CASE("boolean union: what is inside out is turned, with the hollows of all of it", "[boolean_union]") {
  const TriangleSoup hollow = together(ball(1), inside_out(ball(.5)));
  const United all = united(inside_out(hollow));
  CHECK(all.report.turned_components == 2);
  CHECK(all.report.inner_surfaces == 1);
  CHECK(volume(all.soup) == Approx(volume(hollow)));
  const United one = united(together(ball(1), inside_out(ball(.9, 2.5))));
  CHECK(one.report.turned_components == 1);
  CHECK(one.report.inner_surfaces == 0);
  CHECK(volume(one.soup) == Approx(volume(together(ball(1), ball(.9, 2.5)))));
}

TEST_CASE("boolean union: where balls pass through each other, faces end at the cut", "[boolean_union]") {
  const United u = united(together(ball(1), ball(1, 1)));
  CHECK(u.report.cut_faces > 0);
  CHECK(u.report.joined_components == 1);
  for (const auto& t : u.soup.triangles) {
    const WorldPoint &a = u.soup.vertices[t[0]], &b = u.soup.vertices[t[1]], &c = u.soup.vertices[t[2]];
    const WorldPoint m = {(a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3, (a.z + b.z + c.z) / 3};
    const double depth = 1 - std::min(std::hypot(m.x, std::hypot(m.y, m.z)), std::hypot(m.x - 1, std::hypot(m.y, m.z)));
    CHECK(depth < .04);  // chords of balls of 24 meridians, and a piece
  }
}

TEST_CASE("boolean union: a cancelled context ends it", "[boolean_union]") {
  Context cancelled;
  cancelled.cancel = true;
  UnionReport report;
  CHECK_THROWS_AS(boolean_union(together(ball(1), ball(1, .5)), {false, .01}, report, cancelled), Error);
}
