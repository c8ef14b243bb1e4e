// Edges that are flipped in flat places, against the definition of a Delaunay triangulation.
#include <algorithm>
#include <cmath>

#include "features/mesh/flip_flat_edges.h"
#include "support/catch.h"
#include "voxel/random.h"

using namespace isoshell;

namespace {

/// A convex polygon whose corners lie on an ellipse, as a fan around its first one.
FineMesh fan(uint32_t corners) {
  FineMesh mesh;
  for (uint32_t i = 0; i < corners; ++i) {
    const double angle = 6.283185307179586 * (i + .3) / corners;
    mesh.position.push_back({4000 * std::cos(angle), 1500 * std::sin(angle), 700});
  }
  for (uint32_t i = 1; i + 1 < corners; ++i) mesh.triangles.push_back({0, i, i + 1});
  return mesh;
}
double doubled_area(const FineMesh& mesh, const std::array<uint32_t, 3>& t) {
  const WorldPoint &a = mesh.position[t[0]], &b = mesh.position[t[1]], &c = mesh.position[t[2]];
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}
/// Above 0 where d is within the circle around a triangle that turns left.
double in_circle(const WorldPoint& a, const WorldPoint& b, const WorldPoint& c, const WorldPoint& d) {
  const double ax = a.x - d.x, ay = a.y - d.y, bx = b.x - d.x, by = b.y - d.y, cx = c.x - d.x, cy = c.y - d.y;
  return (ax * ax + ay * ay) * (bx * cy - by * cx) - (bx * bx + by * by) * (ax * cy - ay * cx) +
         (cx * cx + cy * cy) * (ax * by - ay * bx);
}
std::vector<std::array<uint32_t, 3>> sorted(FineMesh mesh) {
  for (auto& t : mesh.triangles) std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  std::sort(mesh.triangles.begin(), mesh.triangles.end());
  return mesh.triangles;
}

}  // namespace

TEST_CASE("flat edges: a fan in a plane becomes Delaunay, of the same area", "[features]") {
  for (const uint32_t corners : {4u, 7u, 40u}) {
    INFO(corners << " corners");
    const FineMesh before = fan(corners), after = flip_flat_edges(before);
    REQUIRE(after.triangles.size() == before.triangles.size());
    double area_before = 0, area_after = 0;
    for (const auto& t : before.triangles) area_before += doubled_area(before, t);
    for (const auto& t : after.triangles) {
      CHECK(doubled_area(after, t) > 0);
      area_after += doubled_area(after, t);
      for (const WorldPoint& p : after.position)
        CHECK(in_circle(after.position[t[0]], after.position[t[1]], after.position[t[2]], p) < 1e6);
    }
    CHECK(std::abs(area_after - area_before) < 1e-6 * area_before);
  }
}

TEST_CASE("flat edges: long thin strips become Delaunay to the end, however many flips that takes", "[features]") {
  FineMesh mesh;  // strips of two fans, each from a corner at one end
  constexpr uint32_t n = 200, strips = 3;
  for (uint32_t s = 0; s < strips; ++s) {
    const auto first = uint32_t(mesh.position.size());
    for (const double y : {0., 20.})
      for (uint32_t i = 0; i <= n; ++i) mesh.position.push_back({250. * i, 100. * s + y, 0});
    for (uint32_t i = 1; i < n; ++i) mesh.triangles.push_back({first, first + i, first + i + 1});
    const uint32_t above = first + n + 1, end = first + n;
    for (uint32_t i = 0; i < n; ++i) mesh.triangles.push_back({end, above + i + 1, above + i});
    mesh.triangles.push_back({first, end, above});
    mesh.triangles.erase(
        std::find(mesh.triangles.begin(), mesh.triangles.end(), std::array<uint32_t, 3>{first, end - 1, end}));
    mesh.triangles.push_back({first, end - 1, end});
  }
  for (const auto& t : flip_flat_edges(mesh).triangles) {
    double longest = 0;
    for (size_t i = 0; i < 3; ++i)
      longest = std::max(longest, std::abs(mesh.position[t[i]].x - mesh.position[t[(i + 1) % 3]].x));
    CHECK(longest == 250);
  }
}

TEST_CASE("flat edges: the order of triangles does not show", "[features]") {
  const FineMesh mesh = fan(31);
  FineMesh other = mesh;
  std::reverse(other.triangles.begin(), other.triangles.end());
  for (auto& t : other.triangles) std::rotate(t.begin(), t.begin() + 1, t.end());
  CHECK(sorted(flip_flat_edges(mesh)) == sorted(flip_flat_edges(other)));
}

TEST_CASE("flat edges: edges of paths and of bends stay", "[features]") {
  FineMesh flat = fan(4);
  flat.position = {{0, 0, 0}, {1000, -100, 0}, {2000, 0, 0}, {1000, 100, 0}};
  CHECK(sorted(flip_flat_edges(flat)) != sorted(flat));
  FineMesh with_path = flat;
  with_path.paths.resize(1);
  with_path.paths[0].vertex = {0, 2};
  CHECK(sorted(flip_flat_edges(with_path)) == sorted(flat));
  FineMesh bent = flat;
  bent.position[1].z = bent.position[3].z = 40;
  CHECK(sorted(flip_flat_edges(bent)) == sorted(bent));
}

TEST_CASE("flat edges: the two sides of a thin part do not come to share an edge", "[features]") {
  FineMesh mesh;
  mesh.position = {{0, 0, 0}, {1000, -100, 0}, {2000, 0, 0}, {1000, 100, 0}};
  mesh.paths.resize(1);
  mesh.paths[0].vertex = {0, 1, 2, 3};
  mesh.paths[0].is_loop = true;
  FineMesh above = mesh;
  above.triangles = {{0, 1, 2}, {0, 2, 3}};
  CHECK(sorted(flip_flat_edges(above)) != sorted(above));
  mesh.triangles = above.triangles;
  for (const auto& t : std::vector<std::array<uint32_t, 3>>{{0, 3, 1}, {1, 3, 2}}) mesh.triangles.push_back(t);
  CHECK(sorted(flip_flat_edges(mesh)) == sorted(mesh));
}
