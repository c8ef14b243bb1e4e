// Counts, exact signs and self-intersections of a certificate against integers, hand-made complexes and all pairs.
#include <algorithm>
#include <array>
#include <random>

#include "isoshell/mesh_census.h"
#include "measure/exact_signs.h"
#include "measure/self_intersections.h"
#include "support/catch.h"

using namespace isoshell;

namespace {

__extension__ using Wide = __int128;
using IntPoint = std::array<int64_t, 3>;

int sign_of(Wide value) { return value > 0 ? 1 : value < 0 ? -1 : 0; }

IntPoint operator-(const IntPoint& a, const IntPoint& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

WorldPoint in_world(const IntPoint& p) { return {double(p[0]), double(p[1]), double(p[2])}; }

/// The definition, in integers.
int side(const IntPoint& a, const IntPoint& b, const IntPoint& c, const IntPoint& d) {
  const IntPoint u = b - a, v = c - a, w = d - a;
  Wide volume = 0;
  for (size_t i = 0; i < 3; ++i) {
    const size_t j = (i + 1) % 3, k = (i + 2) % 3;
    volume += (Wide(u[i]) * v[j] - Wide(u[j]) * v[i]) * w[k];
  }
  return sign_of(volume);
}

using IntTriangle = std::array<IntPoint, 3>;

/// Of an edge and a triangle no four of whose corners lie in a plane.
bool pierces(const IntPoint& p, const IntPoint& q, const IntTriangle& t) {
  const int above = side(t[0], t[1], t[2], p), below = side(t[0], t[1], t[2], q);
  REQUIRE(above * below != 0);
  if (above == below) return false;
  const int ab = side(p, q, t[0], t[1]), bc = side(p, q, t[1], t[2]), ca = side(p, q, t[2], t[0]);
  REQUIRE(ab * bc * ca != 0);
  return ab == bc && bc == ca;
}

bool meet(const IntTriangle& s, const IntTriangle& t) {
  for (size_t i = 0; i < 3; ++i)
    if (pierces(s[i], s[(i + 1) % 3], t) || pierces(t[i], t[(i + 1) % 3], s)) return true;
  return false;
}

MeshCensus census(const TriangleMesh& mesh) {
  Context context;
  return take_census(mesh, context);
}

/// Points of which no four lie in a plane: what is counted here asks for indices only.
TriangleMesh complex_of(size_t vertices, std::vector<std::array<uint32_t, 3>> triangles) {
  TriangleMesh mesh;
  for (size_t i = 0; i < vertices; ++i) mesh.vertices.push_back({double(i), double(i * i), double(i * i * i)});
  mesh.triangles = std::move(triangles);
  return mesh;
}

int64_t pairs_of(std::vector<WorldPoint> vertices, std::vector<std::array<uint32_t, 3>> triangles) {
  TriangleMesh mesh;
  mesh.vertices = std::move(vertices);
  mesh.triangles = std::move(triangles);
  return census(mesh).intersecting_pairs;
}

}  // namespace

TEST_CASE("census: the side of a plane is that of integers, in it and one unit beside it", "[census][unit]") {
  std::mt19937_64 random(1);
  const auto within = [&](int64_t reach) { return int64_t(random() % uint64_t(2 * reach + 1)) - reach; };
  const auto point = [&](int64_t reach) { return IntPoint{within(reach), within(reach), within(reach)}; };
  int in_plane = 0;
  for (int n = 0; n < 20000; ++n) {
    const IntPoint a = point(int64_t(1) << 30), b = point(int64_t(1) << 30), c = point(int64_t(1) << 30),
                   beside = point(1);
    const int64_t i = within(8), j = within(8);
    IntPoint d;
    for (size_t k = 0; k < 3; ++k) d[k] = a[k] + i * (b[k] - a[k]) + j * (c[k] - a[k]) + (n % 2 ? beside[k] : 0);
    const int expected = side(a, b, c, d);
    in_plane += expected == 0;
    REQUIRE(side_of_plane(in_world(a), in_world(b), in_world(c), in_world(d)) == expected);
  }
  CHECK(in_plane >= 10000);
}

TEST_CASE("census: a turn is that of integers, straight on and one unit beside it", "[census][unit]") {
  std::mt19937_64 random(2);
  const auto within = [&](int64_t reach) { return int64_t(random() % uint64_t(2 * reach + 1)) - reach; };
  for (int n = 0; n < 20000; ++n) {
    const int64_t reach = int64_t(1) << 40, ax = within(reach), ay = within(reach), bx = within(reach),
                  by = within(reach), i = within(8), cx = ax + i * (bx - ax) + (n % 2 ? within(1) : 0),
                  cy = ay + i * (by - ay) + (n % 2 ? within(1) : 0);
    const int expected = sign_of(Wide(bx - ax) * (cy - ay) - Wide(by - ay) * (cx - ax));
    REQUIRE(turn({double(ax), double(ay)}, {double(bx), double(by)}, {double(cx), double(cy)}) == expected);
  }
}

TEST_CASE("census: signs are exact where differences of coordinates are rounded", "[census][unit]") {
  const double e = 0x1p-80;  // 1 - e is 1 in doubles; the turn is that of -e, the volume that of e
  for (const double by : {e, 0., -e}) {
    const int expected = by > 0 ? 1 : by < 0 ? -1 : 0;
    CHECK(turn({by, 0}, {1, 1}, {2, 2}) == -expected);
    CHECK(side_of_plane({by, 0, 0}, {1, 1, 0}, {0, 0, 1}, {2, 2, 0}) == expected);
  }
}

TEST_CASE("census: self-intersections are those of all pairs", "[census][unit]") {
  std::mt19937_64 random(3);
  TriangleMesh mesh;
  std::vector<IntTriangle> triangles;
  for (uint32_t n = 0; n < 300; ++n) {
    IntPoint middle;
    for (int64_t& x : middle) x = int64_t(random() % 100000);
    IntTriangle triangle;
    for (IntPoint& corner : triangle) {
      for (size_t k = 0; k < 3; ++k) corner[k] = middle[k] + int64_t(random() % 30000);
      mesh.vertices.push_back(in_world(corner));
    }
    triangles.push_back(triangle);
    mesh.triangles.push_back({3 * n, 3 * n + 1, 3 * n + 2});
  }
  int64_t pairs = 0;
  std::vector<bool> meets(triangles.size());
  for (size_t i = 0; i < triangles.size(); ++i)
    for (size_t j = 0; j < i; ++j)
      if (meet(triangles[i], triangles[j])) {
        ++pairs;
        meets[i] = meets[j] = true;
      }
  const MeshCensus found = census(mesh);
  CHECK(pairs > 50);
  CHECK(found.intersecting_pairs == pairs);
  CHECK(found.intersecting_triangles == std::count(meets.begin(), meets.end(), true));
}

TEST_CASE("census: triangles may meet in the corners that they share, and nowhere else", "[census][unit]") {
  // Neighbours in a plane, then folded onto each other.
  CHECK(pairs_of({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {4, 4, 0}}, {{0, 1, 2}, {1, 3, 2}}) == 0);
  CHECK(pairs_of({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 0}}, {{0, 1, 2}, {1, 3, 2}}) == 1);
  // One shared corner: beside each other, then the edge opposite to it goes through the other.
  CHECK(pairs_of({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {-4, 0, 1}, {-4, 1, -1}}, {{0, 1, 2}, {0, 3, 4}}) == 0);
  CHECK(pairs_of({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 1}, {1, 1, -1}}, {{0, 1, 2}, {0, 3, 4}}) == 1);
  // None: a corner touches the inside, then stays above it.
  CHECK(pairs_of({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 0}, {1, 2, 3}, {2, 1, 3}}, {{0, 1, 2}, {3, 4, 5}}) == 1);
  CHECK(pairs_of({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 1e-300}, {1, 2, 3}, {2, 1, 3}}, {{0, 1, 2}, {3, 4, 5}}) == 0);
}

TEST_CASE("census: two tetrahedra that share a vertex are one component with a bow tie", "[census][unit]") {
  const ComplexCounts c =
      census(complex_of(7, {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}, {0, 4, 5}, {0, 6, 4}, {0, 5, 6}, {4, 6, 5}}))
          .counts;
  CHECK(c.edges == 12);
  CHECK(c.components == 1);
  CHECK(c.closed_components == 0);
  CHECK(c.nonmanifold_vertices == 1);
  CHECK(c.bow_ties == 1);
  CHECK(c.nonmanifold_edges == 0);
  CHECK(c.boundary_edges == 0);
  CHECK(c.euler == 3);
  CHECK_FALSE(c.closed_manifold);
}

TEST_CASE("census: an edge of three faces is not manifold, nor are its ends", "[census][unit]") {
  const ComplexCounts c = census(complex_of(5, {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}})).counts;
  CHECK(c.edges == 7);
  CHECK(c.nonmanifold_edges == 1);
  CHECK(c.boundary_edges == 6);
  CHECK(c.nonmanifold_vertices == 2);
  CHECK(c.bow_ties == 0);
  CHECK(c.components == 1);
  CHECK(c.bordered_components == 0);
}

TEST_CASE("census: a Moebius strip of five triangles has one border and no orientation", "[census][unit]") {
  const ComplexCounts c = census(complex_of(5, {{0, 1, 2}, {1, 2, 3}, {2, 3, 4}, {3, 4, 0}, {4, 0, 1}})).counts;
  CHECK(c.edges == 10);
  CHECK(c.euler == 0);
  CHECK(c.boundary_edges == 5);
  CHECK(c.boundary_loops == 1);
  CHECK(c.bordered_components == 1);
  CHECK(c.nonorientable_components == 1);
  CHECK(c.nonmanifold_vertices == 0);
}

TEST_CASE("census: disjoint triangles are components with a border each, loose vertices none", "[census][unit]") {
  const ComplexCounts c = census(complex_of(11, {{0, 1, 2}, {3, 4, 5}, {6, 7, 8}, {9, 9, 10}})).counts;
  CHECK(c.vertices == 11);
  CHECK(c.referenced_vertices == 9);
  CHECK(c.components == 3);
  CHECK(c.bordered_components == 3);
  CHECK(c.boundary_loops == 3);
  CHECK(c.boundary_edges == 9);
  CHECK(c.repeated_corners == 1);
  CHECK(c.euler == 3);
}
