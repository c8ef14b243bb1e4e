// check_mesh on meshes whose topology is known.
#include "isoshell/error.h"
#include "isoshell/mesh_topology.h"
#include "support/catch.h"
#include "support/shapes.h"
#include "support/solid_soup.h"

using namespace isoshell;

namespace {

MeshTopology check(const TriangleSoup& soup) { return check_mesh({soup.vertices, soup.triangles}); }

}  // namespace

TEST_CASE("check: components, genus and Euler number of closed surfaces", "[check][unit]") {
  struct Known {
    TriangleSoup soup;
    int64_t components, genus;
  };
  const Known known[] = {{shapes::box({0, 0, 0}, {1, 1, 1}), 1, 0},
                         {shapes::torus(3, 1, 12, 8), 1, 1},
                         {shapes::cube_frame(7, 2), 1, 5},
                         {shapes::sieve(2, 1, 1, 1), 1, 4},
                         {shapes::together(shapes::torus(3, 1, 9, 5), shapes::sphere({9, 9, 9}, 1, 8)), 2, 1}};
  for (const Known& k : known) {
    const MeshTopology t = check(k.soup);
    CHECK(t.is_closed_manifold());
    CHECK(t.components == k.components);
    CHECK(t.genus == k.genus);
    CHECK(t.euler == 2 * k.components - 2 * k.genus);
    CHECK(t.boundary_loops == 0);
  }
}

TEST_CASE("check: an open torus has two boundary loops per missing triangle pair", "[check][unit]") {
  TriangleSoup soup = shapes::torus(3, 1, 12, 8);
  soup.triangles.erase(soup.triangles.begin() + 100);
  soup.triangles.erase(soup.triangles.begin() + 3);
  const MeshTopology t = check(soup);
  CHECK(t.manifold);
  CHECK_FALSE(t.closed);
  CHECK(t.boundary_loops == 2);
  CHECK(t.boundary_edges == 6);
  CHECK(t.genus == 1);
}

TEST_CASE("check: two fans at a vertex, a third face at an edge and a turned face are found", "[check][unit]") {
  TriangleMesh pinched;
  pinched.vertices.resize(8);
  pinched.triangles = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}, {0, 4, 5}, {0, 6, 4}, {0, 5, 6}, {4, 6, 5}};
  const MeshTopology p = check_mesh(pinched);
  CHECK(p.nonmanifold_vertices == 1);
  CHECK(p.nonmanifold_edges == 0);
  CHECK(p.unreferenced_vertices == 1);
  CHECK(p.components == 1);
  CHECK_FALSE(p.manifold);
  CHECK(p.closed);

  TriangleMesh fan;
  fan.vertices.resize(5);
  fan.triangles = {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}};
  CHECK(check_mesh(fan).nonmanifold_edges == 1);
  CHECK(check_mesh(fan).boundary_edges == 6);

  TriangleSoup turned = shapes::box({0, 0, 0}, {1, 1, 1});
  std::swap(turned.triangles[5][0], turned.triangles[5][1]);
  CHECK(check(turned).nonmanifold_edges == 3);
}

TEST_CASE("check: repeated and degenerate triangles are no manifold", "[check][unit]") {
  TriangleMesh pillow;
  pillow.vertices.resize(3);
  pillow.triangles = {{0, 1, 2}, {0, 2, 1}};
  CHECK(check_mesh(pillow).repeated_triangles == 1);
  CHECK(check_mesh(pillow).nonmanifold_edges == 0);
  CHECK_FALSE(check_mesh(pillow).manifold);
  TriangleSoup box = shapes::box({0, 0, 0}, {1, 1, 1});
  box.triangles.push_back({3, 3, 4});
  CHECK(check(box).degenerate_triangles == 1);
  CHECK_FALSE(check(box).manifold);
}

TEST_CASE("check: an index out of range is an error, no triangles are no closed mesh", "[check][unit]") {
  TriangleMesh bad;
  bad.vertices.resize(3);
  CHECK_FALSE(check_mesh(bad).closed);
  bad.triangles = {{0, 1, 3}};
  CHECK_THROWS_AS(check_mesh(bad), Error);
}
