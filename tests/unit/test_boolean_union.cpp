// The union of the components of a soup, and the rays that windings are counted with.
#include <algorithm>
#include <cmath>

#include "geometry/weld.h"
#include "isoshell/advanced/stages.h"
#include "isoshell/boolean_union.h"
#include "isoshell/error.h"
#include "measure/box_tree.h"
#include "repair/arrangement/step_frame.h"
#include "repair/solids/winding.h"
#include "support/catch.h"
#include "support/shapes.h"
#include "voxel/intersect.h"

using namespace isoshell;
using shapes::box;
using shapes::inside_out;
using shapes::together;

namespace {

struct United {
  TriangleSoup soup;
  std::vector<std::array<WorldPoint, 2>> interfaces;
  UnionReport report;
};

United united(const TriangleSoup& soup, const UnionOptions& options = {}) {
  United u;
  const Context context;
  UnitedSoup made = boolean_union(soup, options, u.report, context);
  u.soup = std::move(made.soup);
  u.interfaces = std::move(made.interfaces);
  return u;
}
UnionOptions outer_only() {
  UnionOptions options;
  options.outer_only = true;
  return options;
}

/// Closed, with two faces at every edge, of this volume and genus.
United check_union(const TriangleSoup& parts, double volume, int64_t genus, int64_t components = 1,
                   const UnionOptions& options = {}) {
  Context context;
  const United u = united(parts, options);
  INFO(u.report.given_up);
  CHECK(u.report.given_up.empty());
  const InputTopology found = measure_topology(u.soup, context).topology;
  CHECK(found.closed);
  CHECK(found.oriented);
  CHECK(found.components == components);
  CHECK(found.genus == genus);
  CHECK(isoshell::volume(u.soup) == Approx(volume).epsilon(1e-6));
  return u;
}

TriangleSoup boxes_in_a_row(int count) {
  TriangleSoup all = box({0, 0, 0}, {1, 1, 1});
  for (int i = 1; i < count; ++i) all = together(all, box({double(i), 0, 0}, {i + 1., 1, 1}));
  return all;
}

TriangleSoup ball(double radius, double x = 0) { return shapes::sphere({x, 0, 0}, radius, 24); }

/// Boxes between whole numbers below 6, whose corners are then moved by up to `noise`.
struct GridBoxes {
  TriangleSoup soup;
  int cells = 0;  ///< of the grid that they cover

  GridBoxes(uint64_t seed, double noise) {
    bool is_covered[6][6][6] = {};
    uint64_t next = 0;
    const auto below = [&](uint64_t count) { return int(random_bits(seed, next++) % count); };
    for (int boxes = 2 + below(6); boxes > 0; --boxes) {
      const int x = below(5), y = below(5), z = below(5);
      const int to_x = x + 1 + below(uint64_t(5 - x)), to_y = y + 1 + below(uint64_t(5 - y)),
                to_z = z + 1 + below(uint64_t(5 - z));
      soup = together(soup, box({double(x), double(y), double(z)}, {double(to_x), double(to_y), double(to_z)}));
      for (int i = x; i < to_x; ++i)
        for (int j = y; j < to_y; ++j)
          for (int k = z; k < to_z; ++k) is_covered[i][j][k] = true;
    }
    for (const auto& plane : is_covered)
      for (const auto& row : plane) cells += int(std::count(row, row + 6, true));
    for (WorldPoint& p : soup.vertices)
      for (double* x : {&p.x, &p.y, &p.z}) *x += noise * (below(2001) / 1000. - 1);
  }
};

/// Triangles of the result that meet outside of what they share, on the lattice that faces are cut on.
size_t count_crossings(const TriangleSoup& result, const TriangleSoup& input) {
  const repair::StepFrame frame(box_of(input.vertices, input.triangles));
  const WeldedVertices welded = weld_vertices(result.vertices, result.triangles);
  std::vector<CornersAt<repair::StepPoint>> all;
  std::vector<BoxQ8> boxes;
  for (const auto& [a, b, c] : result.triangles) {
    all.push_back({{welded.place[a], welded.place[b], welded.place[c]},
                   {frame.from(result.vertices[a]), frame.from(result.vertices[b]), frame.from(result.vertices[c])}});
    const auto& at = all.back().at;
    boxes.push_back(repair::coarse(box_of(at[0], at[1], at[2])));
  }
  const BoxTree tree(boxes);
  size_t count = 0;
  for (size_t g = 0; g < tree.groups(); ++g)
    tree.for_pairs_of(g, [&](uint32_t s, uint32_t t) { count += triangles_intersect(all[s], all[t]) ? 1 : 0; });
  return count;
}

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
  const United outer = united(hollow, outer_only());
  CHECK(outer.report.dropped_inner == 1);
  CHECK(volume(outer.soup) == Approx(volume(ball(1))));
}

TEST_CASE("boolean union: three balls in each other, turned in and out, all stay; turned inward in a hollow, one goes",
          "[boolean_union]") {
  const TriangleSoup hollow = together(ball(1), inside_out(ball(.7)));
  const United nested = united(together(hollow, ball(.4)));
  CHECK_FALSE(nested.report.changed_anything());
  CHECK(nested.report.inner_surfaces == 1);
  CHECK(united(together(hollow, ball(.4)), outer_only()).report.dropped_inner == 2);
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

TEST_CASE("boolean union: where balls pass through each other, faces are cut along the line where they do",
          "[boolean_union]") {
  const TriangleSoup balls = together(ball(1), ball(1, 1));
  const double lens_of_ball = 5. / 16;  // of two balls of radius 1, each with its middle on the other
  const United u = united(balls);
  CHECK(isoshell::volume(u.soup) == Approx((2 - lens_of_ball) * isoshell::volume(ball(1))).epsilon(.01));
  check_union(balls, isoshell::volume(u.soup), 0);
  CHECK(u.report.cut_faces > 0);
  const auto depth_of = [](const WorldPoint& p) {
    return 1 - std::min(std::hypot(p.x, std::hypot(p.y, p.z)), std::hypot(p.x - 1, std::hypot(p.y, p.z)));
  };
  for (const WorldPoint& p : u.soup.vertices) CHECK(depth_of(p) < .03);  // chords of balls of 24 meridians
}

TEST_CASE("boolean union: bars that cross have the volume of both less that of what they share", "[boolean_union]") {
  const United u = check_union(together(box({0, 2, 0}, {6, 4, 2}), box({2, 0, .5}, {4, 6, 1.5})), 24 + 12 - 4, 0);
  CHECK(u.soup.triangles.size() == 2 * (8 + 8 + 8) - 4);  // no corners but the boxes' and those where edges pass walls
}

TEST_CASE("boolean union: parts look outward whichever way their faces were, before they are united",
          "[boolean_union]") {
  const TriangleSoup one = box({0, 2, 0}, {6, 4, 2}), other = box({2, 0, .5}, {4, 6, 1.5});
  const United outward = check_union(together(one, other), 32, 0);
  for (const TriangleSoup& parts : {together(inside_out(one), other), together(one, inside_out(other)),
                                    together(inside_out(one), inside_out(other))}) {
    const United u = check_union(parts, 32, 0);
    CHECK(u.report.turned_components > 0);
    CHECK(u.soup.triangles.size() == outward.soup.triangles.size());
  }
}

TEST_CASE("boolean union: a box on a part of another one's top becomes one solid with it", "[boolean_union]") {
  const United u = check_union(together(box({0, 0, 0}, {4, 4, 1}), box({1, 1, 1}, {3, 3, 3})), 16 + 8, 0);
  CHECK(u.report.internal_faces > 0);
  CHECK(u.interfaces.size() == 4);
}

TEST_CASE("boolean union: walls in one plane leave nothing of the inner one", "[boolean_union]") {
  check_union(together(box({0, 0, 0}, {4, 4, 1}), box({0, 0, 0}, {2, 4, 3})), 16 + 16, 0);
}

TEST_CASE("boolean union: four bars around a window bound a solid of genus 1", "[boolean_union]") {
  const TriangleSoup across = together(box({0, 0, 0}, {6, 1, 1}), box({0, 5, 0}, {6, 6, 1}));
  const TriangleSoup along = together(box({.5, -1, .5}, {1.5, 7, 2}), box({4.5, -1, .5}, {5.5, 7, 2}));
  check_union(together(across, along), 2 * 6 + 2 * 12 - 4 * .5, 1);
}

TEST_CASE("boolean union: rooms that walls enclose stay, and are solid where only outer surfaces are wanted",
          "[boolean_union]") {
  TriangleSoup house = together(box({0, 0, 0}, {6, 6, 1}), box({0, 0, 3}, {6, 6, 4}));
  house = together(house, together(box({0, 0, .5}, {1, 6, 3.5}), box({5, 0, .5}, {6, 6, 3.5})));
  house = together(house, together(box({0, 0, .5}, {6, 1, 3.5}), box({0, 5, .5}, {6, 6, 3.5})));
  check_union(house, 6 * 6 * 4 - 4 * 4 * 2, 0, 2);
  check_union(house, 6 * 6 * 4, 0, 1, outer_only());
}

TEST_CASE("boolean union: boxes that share faces become one solid, with a ring of edges around each wall",
          "[boolean_union]") {
  for (const int count : {2, 3, 5}) {
    const United u = check_union(boxes_in_a_row(count), count, 0);
    CHECK(u.report.internal_faces == 2 * (count - 1));
    CHECK(u.report.swallowed_components == 0);
    CHECK(u.interfaces.size() == size_t(4 * (count - 1)));
    for (const auto& edge : u.interfaces) CHECK(edge[0].x == edge[1].x);
  }
}

TEST_CASE("boolean union: walls of one face between cells go, whichever way the faces look", "[boolean_union]") {
  Context context;
  TriangleSoup soup = boxes_in_a_row(2);
  const auto is_on_wall = [&](const std::array<uint32_t, 3>& t) {
    return std::all_of(t.begin(), t.end(), [&](uint32_t v) { return soup.vertices[v].x == 1; });
  };
  TriangleSoup single = soup;
  single.triangles.clear();
  int walls = 0;
  for (const auto& t : soup.triangles)
    if (!is_on_wall(t) || ++walls <= 2) single.triangles.push_back(t);
  for (size_t turned = 0; turned < single.triangles.size(); ++turned) {
    INFO("turned face " << turned);
    TriangleSoup other = single;
    std::swap(other.triangles[turned][1], other.triangles[turned][2]);
    const United u = united(other);
    if (!u.report.changed_anything()) continue;  // an edge whose two faces disagree: repair comes first
    const InputTopology found = measure_topology(u.soup, context).topology;
    CHECK(found.closed);
    CHECK(found.oriented);
    CHECK(isoshell::volume(u.soup) == Approx(2));
  }
  check_union(single, 2, 0);
}

TEST_CASE("boolean union: a hollow between parts stays one", "[boolean_union]") {
  TriangleSoup all;  // a shell of 26 boxes around the middle one of 27, which is air
  for (int i = 0; i < 27; ++i) {
    if (i == 13) continue;
    const WorldPoint lo{double(i % 3), double(i / 3 % 3), double(i / 9)};
    all = together(all, box(lo, {lo.x + 1, lo.y + 1, lo.z + 1}));
  }
  check_union(all, 26, 0, 2);
}

TEST_CASE("boolean union: where boxes share an edge alone, the result has two sheets a gap apart", "[boolean_union]") {
  UnionOptions options;
  options.sheet_gap_world = 1e-4;
  TriangleSoup stairs =
      together(box({0, 0, 0}, {2, 2, 1}), together(box({0, 0, 1}, {1, 1, 2}), box({1, 1, 1}, {2, 2, 2})));
  const United u = united(stairs, options);
  Context context;
  const InputTopology found = measure_topology(u.soup, context).topology;
  CHECK(found.closed);
  CHECK(found.oriented);
  CHECK(found.components == 1);
  CHECK(isoshell::volume(u.soup) == Approx(6).epsilon(1e-3));
  stairs = together(box({0, 0, 0}, {1, 1, 1}), box({1, 1, 0}, {2, 2, 1}));
  const United apart = united(stairs, options);
  CHECK(apart.report.separated_edges == 1);
  CHECK(measure_topology(apart.soup, context).topology.components == 2);
  CHECK(isoshell::volume(apart.soup) < 2);
  CHECK(isoshell::volume(apart.soup) > 2 - 4 * options.sheet_gap_world);
}

TEST_CASE("boolean union: parts are cut only where they meet, and pieces are no more than their outlines need",
          "[boolean_union]") {
  TriangleSoup comb = box({0, 0, 0}, {100, 1, 1});
  for (int i = 0; i < 24; ++i) comb = together(comb, box({4. * i + 1, .2, .5}, {4. * i + 3, .8, 3}));
  const United u = check_union(comb, 100 + 24 * 2 * .6 * 2, 0);
  CHECK(u.report.internal_faces == 0);
  CHECK(u.soup.triangles.size() < 24 * 30);
}

TEST_CASE("boolean union: hollows that share an edge or a wall, overlap, or come first in the input, stay",
          "[boolean_union]") {
  const TriangleSoup block = box({0, 0, 0}, {10, 10, 10});
  const auto hollow = [](WorldPoint lo, WorldPoint hi) { return inside_out(box(lo, hi)); };
  check_union(together(block, together(hollow({2, 2, 2}, {3, 3, 3}), hollow({3, 2, 2}, {4, 3, 3}))), 998, 0, 2);
  UnionOptions options;
  options.sheet_gap_world = 1e-6;
  const United apart =
      united(together(block, together(hollow({2, 2, 2}, {3, 3, 3}), hollow({3, 3, 2}, {4, 4, 3}))), options);
  CHECK(isoshell::volume(apart.soup) == Approx(998));
  check_union(together(block, together(hollow({2, 2, 2}, {4, 4, 4}), hollow({3, 3, 3}, {5, 5, 5}))), 1000 - 15, 0, 2);
  const TriangleSoup shells = together(hollow({2, 2, 2}, {4, 4, 4}), inside_out(block));
  check_union(together(shells, box({20, 0, 0}, {40, 20, 20})), 1000 - 8 + 8000, 0, 3);
}

TEST_CASE("boolean union: an open part stays as it is beside others, if it is to be kept and meets none",
          "[boolean_union]") {
  TriangleSoup sheet;
  sheet.vertices = {{10, 0, 0}, {11, 0, 0}, {10, 1, 0}};
  sheet.triangles = {{0, 1, 2}};
  const TriangleSoup parts = together(together(box({0, 2, 0}, {6, 4, 2}), box({2, 0, .5}, {4, 6, 1.5})), sheet);
  CHECK_FALSE(united(parts).report.changed_anything());
  UnionOptions options;
  options.keeps_open = true;
  const United u = united(parts, options);
  CHECK(u.report.left_components == 1);
  CHECK(u.report.cut_faces > 0);
  Context context;
  CHECK(measure_topology(u.soup, context).topology.boundary_loops == 1);
}

TEST_CASE("boolean union: boxes whose planes are one or nearly are as much as the cells of the grid that they cover",
          "[boolean_union]") {
  int given_up = 0;
  for (uint64_t seed = 0; seed < 160; ++seed)
    for (const double noise : {0., 1e-7, 1e-5, 1e-4}) {
      CAPTURE(seed, noise);
      const GridBoxes boxes(seed, noise);
      const United u = united(boxes.soup);
      if (!u.report.given_up.empty()) {
        CHECK(noise > 1e-7);
        ++given_up;
        continue;
      }
      CHECK(isoshell::volume(u.soup) == Approx(boxes.cells).epsilon(1e-7 + 10 * noise));
      if (u.report.cut_faces > 0 && u.report.separated_edges == 0) CHECK(count_crossings(u.soup, boxes.soup) == 0);
    }
  CHECK(given_up < 16);
}

TEST_CASE("boolean union: a cancelled context ends it", "[boolean_union]") {
  Context cancelled;
  cancelled.cancel = true;
  UnionReport report;
  CHECK_THROWS_AS(boolean_union(together(ball(1), ball(1, .5)), {}, report, cancelled), Error);
}
