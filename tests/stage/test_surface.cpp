// Measuring and snapping a soup.
#include <cmath>
#include <limits>

#include "isoshell/advanced/digest.h"
#include "isoshell/error.h"
#include "support/catch.h"
#include "support/site_shapes.h"
#include "support/test_context.h"
#include "voxel/leaf.h"

using namespace isoshell;

namespace {

/// Every triangle with its own three vertices.
TriangleSoup exploded(const TriangleSoup& soup) {
  TriangleSoup s;
  for (const auto& t : soup.triangles) {
    for (uint32_t v : t) s.vertices.push_back(soup.vertices[v]);
    const uint32_t n = uint32_t(s.vertices.size());
    shapes::add_triangle(s, n - 3, n - 2, n - 1);
  }
  return s;
}

TriangleSoup tetrahedron(WorldPoint apex, double side) {
  TriangleSoup s;
  s.vertices = {
      apex, {apex.x + side, apex.y, apex.z}, {apex.x, apex.y + side, apex.z}, {apex.x, apex.y, apex.z + side}};
  s.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  return s;
}

InputTopology measured(const TriangleSoup& soup, DirtCounts& dirt, int threads = 2) {
  TestContext context;
  context.threads = threads;
  const SoupTopology found = measure_topology(soup, context);
  dirt = found.dirt;
  return found.topology;
}
InputTopology measured(const TriangleSoup& soup) {
  DirtCounts dirt;
  return measured(soup, dirt);
}

bool same(const InputTopology& a, const InputTopology& b) {
  return a.closed == b.closed && a.oriented == b.oriented && a.components == b.components &&
         a.boundary_loops == b.boundary_loops && a.euler == b.euler && a.genus == b.genus &&
         a.area_world == b.area_world;
}

}  // namespace

TEST_CASE("surface: closed shapes have their known topology, welded or not", "[surface][stage]") {
  const TriangleSoup both = shapes::together(shapes::torus(2, .5, 20, 10), shapes::sphere({0, 0, 9}, 1, 12));
  for (const TriangleSoup& soup : {both, exploded(both)}) {
    DirtCounts dirt;
    const InputTopology t = measured(soup, dirt);
    CHECK(t.closed);
    CHECK(t.oriented);
    CHECK(t.components == 2);
    CHECK(t.boundary_loops == 0);
    CHECK(t.euler == 2);
    CHECK(t.genus == 1);
    CHECK(dirt.duplicate_faces + dirt.degenerate_faces + dirt.nonmanifold_edges + dirt.inconsistent_edges == 0);
  }
  CHECK(measured(shapes::box({0, 0, 0}, {3, 2, 1})).area_world == 22);
}

TEST_CASE("surface: minus zero and zero are one position", "[surface][stage]") {
  TriangleSoup soup = exploded(tetrahedron({0, 0, 0}, 1));
  for (size_t i = 0; i < soup.vertices.size(); i += 2)
    for (double* c : {&soup.vertices[i].x, &soup.vertices[i].y, &soup.vertices[i].z})
      if (*c == 0) *c = -0.0;
  CHECK(measured(soup).genus == 0);
}

TEST_CASE("surface: open sheets have boundary loops and no genus", "[surface][stage]") {
  const InputTopology t = measured(shapes::two_sheets(1, .1));
  CHECK_FALSE(t.closed);
  CHECK_FALSE(t.oriented);
  CHECK(t.components == 2);
  CHECK(t.boundary_loops == 2);
  CHECK(t.euler == 2);
  CHECK(t.genus == -1);
}

TEST_CASE("surface: a turned face is inconsistent, yet the genus is known", "[surface][stage]") {
  TriangleSoup soup = shapes::torus(2, .5, 8, 6);
  std::swap(soup.triangles[5][0], soup.triangles[5][1]);
  DirtCounts dirt;
  const InputTopology t = measured(soup, dirt);
  CHECK(t.closed);
  CHECK_FALSE(t.oriented);
  CHECK(dirt.inconsistent_edges == 3);
  CHECK(t.genus == 1);
}

TEST_CASE("surface: neither a projective plane nor a pinched vertex has a genus", "[surface][stage]") {
  TriangleSoup plane;
  for (int i = 0; i < 6; ++i) plane.vertices.push_back({double(i), double(i * i), double(i * i * i)});
  plane.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}, {0, 5, 1},
                     {1, 2, 4}, {2, 3, 5}, {3, 4, 1}, {4, 5, 2}, {5, 1, 3}};
  const InputTopology p = measured(plane);
  CHECK(p.closed);
  CHECK(p.euler == 1);
  CHECK(p.genus == -1);

  const InputTopology pinched = measured(shapes::together(tetrahedron({0, 0, 0}, 1), tetrahedron({0, 0, 0}, -1)));
  CHECK(pinched.closed);
  CHECK(pinched.components == 1);
  CHECK(pinched.euler == 3);
  CHECK(pinched.genus == -1);
}

TEST_CASE("surface: dirt is counted by kind and left out of the topology", "[surface][stage]") {
  TriangleSoup soup = shapes::box({0, 0, 0}, {1, 1, 1});
  const auto first = soup.triangles[0];
  soup.triangles.push_back({first[1], first[2], first[0]});
  soup.triangles.push_back({first[0], first[0], first[1]});
  DirtCounts dirt;
  const InputTopology t = measured(soup, dirt);
  CHECK(dirt.duplicate_faces == 1);
  CHECK(dirt.degenerate_faces == 1);
  CHECK(t.genus == 0);
  CHECK(t.area_world == 6);

  soup.triangles.push_back({first[0], first[2], first[1]});
  dirt = {};
  measured(soup, dirt);
  CHECK(dirt.duplicate_faces == 2);
  CHECK(dirt.nonmanifold_edges == 3);

  TriangleSoup fan;
  fan.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, -1, 0}, {.5, 0, 0}};
  fan.triangles = {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}, {0, 5, 1}};
  dirt = {};
  measured(fan, dirt);
  CHECK(dirt.nonmanifold_edges == 1);
  CHECK(dirt.degenerate_faces == 1);
}

TEST_CASE("surface: vertices that no triangle uses do not matter", "[surface][stage]") {
  TriangleSoup soup = shapes::box({0, 0, 0}, {3, 2, 1});
  TestContext context;
  const uint64_t expect = digest(shapes::snapped(soup, 20, context));
  soup.vertices.push_back({std::nan(""), std::numeric_limits<double>::infinity(), 1e300});
  CHECK(digest(shapes::snapped(soup, 20, context)) == expect);
  CHECK(measured(soup).euler == 2);
}

TEST_CASE("surface: a soup without triangles is nothing to mesh", "[surface][stage]") {
  TestContext context;
  CHECK_THROWS_AS(bounding_box({}), Error);
  CHECK_THROWS_AS(snap_surface({}, LatticeFrame::around({0, 0, 0}, {1, 1, 1}, 8), context), Error);
}

TEST_CASE("surface: points and triangles are canonical, and each triangle is its source's", "[surface][stage]") {
  TestContext context;
  for (const auto& [name, soup] : shapes::ugly_soups()) {
    INFO(name);
    const LatticeSurface s = shapes::snapped(soup, 37, context);
    const auto key = [](PointQ8 p) { return leaf_key({p.x >> 11, p.y >> 11, p.z >> 11}); };
    int64_t wrong = 0;
    for (int64_t i = 1; i < s.points.size(); ++i) {
      const PointQ8 p = s.points[i - 1], q = s.points[i];
      const bool before = key(p) != key(q) ? key(p) < key(q)
                          : p.x != q.x     ? p.x < q.x
                          : p.y != q.y     ? p.y < q.y
                                           : p.z < q.z;
      wrong += !before;
    }
    for (int64_t i = 0; i < s.triangles.size(); ++i) {
      const TriangleIndices t = s.triangles[i];
      wrong += t.a > t.b || t.a > t.c;
      const auto& from = soup.triangles[s.source_face[i]];
      const PointQ8 corner[3] = {s.points[t.a], s.points[t.b], s.points[t.c]};
      int turns = 0;
      for (size_t turn = 0; turn < 3; ++turn) {
        bool equal = true;
        for (size_t k = 0; k < 3; ++k) equal = equal && s.frame.snap(soup.vertices[from[(turn + k) % 3]]) == corner[k];
        turns += equal;
      }
      wrong += turns == 0;
      if (i == 0) continue;
      const TriangleIndices b = s.triangles[i - 1];
      wrong += !(b.a != t.a ? b.a < t.a : b.b != t.b ? b.b < t.b : b.c < t.c);
    }
    CHECK(wrong == 0);
  }
}

TEST_CASE("surface: order of the file and threads change nothing", "[surface][stage][parity]") {
  for (const auto& [name, soup] : shapes::ugly_soups()) {
    INFO(name);
    TestContext one;
    one.threads = 1;
    DirtCounts dirt;
    const InputTopology expect = measured(soup, dirt, 1);
    const uint64_t expect_digest = digest(shapes::snapped(soup, 100, one));
    for (uint64_t seed = 0; seed < 3; ++seed) {
      const TriangleSoup other = shapes::shuffled(soup, seed);
      DirtCounts other_dirt;
      TestContext two;
      two.threads = 2;
      CHECK(same(measured(other, other_dirt), expect));
      CHECK(other_dirt.degenerate_faces == dirt.degenerate_faces);
      CHECK(other_dirt.duplicate_faces == dirt.duplicate_faces);
      CHECK(digest(shapes::snapped(other, 100, two)) == expect_digest);
    }
  }
}

TEST_CASE("surface: what closes holes stays known on the lattice", "[surface][stage]") {
  TriangleSoup soup = shapes::box({0, 0, 0}, {1, 1, 1});
  soup.first_cap = 10;
  TestContext context;
  CHECK(snap_surface(soup, LatticeFrame::around({0, 0, 0}, {1, 1, 1}, 16), context).first_cap == 10);
}
