// Triangles thinner than rounding can tell: flipped or collapsed away, and what stays.
#include <algorithm>
#include <map>
#include <vector>

#include "features/known_curves.h"
#include "features/mesh/remove_slivers.h"
#include "geometry/box.h"
#include "geometry/half_edges.h"
#include "support/catch.h"

using namespace isoshell;
using namespace isoshell::known_curves;

namespace {

/// A box, 4 x 2 x 1, on whose upper front edge the front has vertices at these places, and the top none: triangles
/// without area are between them.
TriangleSoup box_with_points_on_edge(const std::vector<double>& places) {
  TriangleSoup soup;
  for (const double z : {0., 1.})
    for (const auto& [x, y] : std::vector<std::pair<double, double>>{{0, 0}, {4, 0}, {4, 2}, {0, 2}})
      soup.vertices.push_back({x, y, z});
  for (const double x : places) soup.vertices.push_back({x, 0, 1});
  const auto last = uint32_t(7 + places.size());
  const auto quad = [&](uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    shapes::add_triangle(soup, a, b, c);
    shapes::add_triangle(soup, a, c, d);
  };
  quad(0, 3, 2, 1);
  quad(4, 5, 6, 7);
  quad(1, 2, 6, 5);
  quad(2, 3, 7, 6);
  quad(3, 0, 4, 7);
  shapes::add_triangle(soup, 0, 1, 5);
  shapes::add_triangle(soup, 0, 5, last);
  for (uint32_t q = last; q > 8; --q) shapes::add_triangle(soup, 0, q, q - 1);
  shapes::add_triangle(soup, 0, 8, 4);
  shapes::add_triangle(soup, 4, 8, 5);
  for (uint32_t q = 8; q < last; ++q) shapes::add_triangle(soup, 5, q, q + 1);
  return soup;
}

double least_height_in(const FeatureMesh& mesh) {
  double least = 1e300;
  for (const auto& [a, b, c] : mesh.triangles) {
    const WorldPoint &p = mesh.vertices[a], &q = mesh.vertices[b], &r = mesh.vertices[c];
    const double longest = std::sqrt(std::max({distance_sq(p, q), distance_sq(q, r), distance_sq(r, p)}));
    least = std::min(least, length(doubled_area(p, q, r)) / longest);
  }
  return least;
}
bool is_closed(const FeatureMesh& mesh) {
  std::map<std::pair<uint32_t, uint32_t>, int> uses;
  for (const auto& t : mesh.triangles)
    for (size_t i = 0; i < 3; ++i) {
      ++uses[{t[i], t[(i + 1) % 3]}];
      --uses[{t[(i + 1) % 3], t[i]}];
    }
  return std::all_of(uses.begin(), uses.end(), [](const auto& use) { return use.second == 0; });
}
bool has_edge(const FeatureMesh& mesh, uint64_t edge) {
  for (const auto& t : mesh.triangles)
    for (size_t i = 0; i < 3; ++i)
      if (edge_key(t[i], t[(i + 1) % 3]) == edge) return true;
  return false;
}
uint32_t vertex_at(const FeatureMesh& mesh, const WorldPoint& p) {
  return uint32_t(std::find_if(mesh.vertices.begin(), mesh.vertices.end(),
                               [&](const WorldPoint& q) { return distance_sq(p, q) == 0; }) -
                  mesh.vertices.begin());
}

/// A cube of side 2 around 0 whose edges and corners are cut off, so wide.
TriangleSoup bevelled_cube(double width) {
  TriangleSoup soup;
  const auto sign = [](uint32_t corner, uint32_t axis) { return corner >> axis & 1 ? 1. : -1.; };
  for (uint32_t corner = 0; corner < 8; ++corner)  // three points each, on the face of each axis
    for (uint32_t axis = 0; axis < 3; ++axis) {
      const auto on_axis = [&](uint32_t i) { return sign(corner, i) * (i == axis ? 1 : 1 - width); };
      soup.vertices.push_back({on_axis(0), on_axis(1), on_axis(2)});
    }
  const auto outward = [&](uint32_t a, uint32_t b, uint32_t c) {
    const WorldPoint &p = soup.vertices[a], &q = soup.vertices[b], &r = soup.vertices[c];
    if (dot(doubled_area(p, q, r), p + q + r) < 0) std::swap(b, c);
    shapes::add_triangle(soup, a, b, c);
  };
  const auto quad = [&](uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    outward(a, b, c);
    outward(a, c, d);
  };
  for (uint32_t corner = 0; corner < 8; ++corner) outward(3 * corner, 3 * corner + 1, 3 * corner + 2);
  for (uint32_t axis = 0; axis < 3; ++axis) {
    const uint32_t u = 1u << (axis + 1) % 3, v = 1u << (axis + 2) % 3, up = 1u << axis;
    for (const uint32_t side : {0u, up})
      quad(3 * side + axis, 3 * (side + u) + axis, 3 * (side + u + v) + axis, 3 * (side + v) + axis);
    for (const uint32_t at : {0u, u, v, u + v}) {  // along the axis
      const uint32_t one = (axis + 1) % 3, other = (axis + 2) % 3;
      quad(3 * at + one, 3 * (at + up) + one, 3 * (at + up) + other, 3 * at + other);
    }
  }
  return soup;
}

LatticeFrame frame_of(const FeatureMesh& mesh) {
  const auto box = box_of(mesh.vertices);
  return LatticeFrame::around(box.min, box.max, 1024);
}

double volume_of(const FeatureMesh& mesh) {
  double volume = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    volume += dot(mesh.vertices[a], cross(mesh.vertices[b], mesh.vertices[c])) / 6;
  return volume;
}

const Context context;

}  // namespace

TEST_CASE("slivers: triangles without area along an edge go, and the edge is the crease that it was",
          "[features][unit]") {
  FeatureMesh mesh = weld_for_features(box_with_points_on_edge({.5, 1.1, 1.2, 2.7, 3.9}));
  const size_t triangles = mesh.triangles.size(), vertices = mesh.vertices.size();
  REQUIRE(least_height_in(mesh) == 0);
  CHECK(remove_slivers(mesh, frame_of(mesh), {}, 0, context));
  CHECK(mesh.triangles.size() == triangles);
  CHECK(mesh.vertices.size() == vertices);
  CHECK(is_closed(mesh));
  CHECK(least_height_in(mesh) > least_height_world(mesh));
  CHECK(counts_of(find_curves(mesh, {CreaseMode::automatic, 0, .2})) == Counts{12, 0, 0, 0, 8});
  CHECK_FALSE(remove_slivers(mesh, frame_of(mesh), {}, 0, context));
}

TEST_CASE("slivers: edges shorter than rounding tells are collapsed", "[features][unit]") {
  FeatureMesh mesh = weld_for_features(box_with_points_on_edge({1, 1 + 1e-6, 1 + 2e-6, 3, 4 - 1e-6}));
  CHECK(remove_slivers(mesh, frame_of(mesh), {}, 0, context));
  CHECK(mesh.vertices.size() == 8 + 2);
  CHECK(mesh.triangles.size() == 2 * mesh.vertices.size() - 4);
  CHECK(mesh.source_face.size() == mesh.triangles.size());
  CHECK(is_closed(mesh));
  CHECK(least_height_in(mesh) > least_height_world(mesh));
}

TEST_CASE("slivers: edges that are to stay do", "[features][unit]") {
  FeatureMesh mesh = weld_for_features(box_with_points_on_edge({1, 1 + 1e-6, 3}));
  const WorldPoint left{0, 0, 1}, right{4, 0, 1};
  CHECK(has_edge(mesh, edge_key(vertex_at(mesh, left), vertex_at(mesh, right))));
  remove_slivers(mesh, frame_of(mesh), {edge_key(vertex_at(mesh, left), vertex_at(mesh, right))}, 0, context);
  CHECK(is_closed(mesh));
  CHECK(has_edge(mesh, edge_key(vertex_at(mesh, left), vertex_at(mesh, right))));
}

TEST_CASE("slivers: a round edge in steps that are far shorter than rounding tells keeps its shape",
          "[features][unit]") {
  FeatureMesh mesh = weld_for_features(cylinder(3000, 1, 1));
  mesh.rounding_world = .04 / 16;  // twenty steps
  CHECK(remove_slivers(mesh, frame_of(mesh), {}, 0, context));
  CHECK(is_closed(mesh));
  CHECK(mesh.vertices.size() < 1000);
  CHECK(volume_of(mesh) == Approx(kTau / 2).epsilon(.002));
}

TEST_CASE("slivers: bevels narrower than a 32nd of an edge become one crease each, wider ones stay",
          "[features][unit]") {
  for (const double edge : {.2, 0.}) {
    FeatureMesh mesh = weld_for_features(bevelled_cube(.002));
    CHECK(remove_slivers(mesh, frame_of(mesh), {}, edge, context) == (edge > 0));
    CHECK(is_closed(mesh));
    CHECK(mesh.vertices.size() == (edge > 0 ? 8 : 24));
    CHECK(volume_of(mesh) == Approx(8).epsilon(.005));
    if (edge > 0) CHECK(counts_of(find_curves(mesh, {CreaseMode::automatic, 0, edge})) == Counts{12, 0, 0, 0, 8});
  }
  FeatureMesh wide = weld_for_features(bevelled_cube(.02));
  CHECK_FALSE(remove_slivers(wide, frame_of(wide), {}, .2, context));
  CHECK(wide.vertices.size() == 24);
}

TEST_CASE("slivers: bevels whose edges are to stay do", "[features][unit]") {
  FeatureMesh mesh = weld_for_features(bevelled_cube(.002));
  std::vector<uint64_t> kept;
  for (const auto& t : mesh.triangles)
    for (size_t i = 0; i < 3; ++i) kept.push_back(edge_key(t[i], t[(i + 1) % 3]));
  std::sort(kept.begin(), kept.end());
  kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
  CHECK_FALSE(remove_slivers(mesh, frame_of(mesh), kept, .2, context));
}

TEST_CASE("slivers: sides of a wall thinner than a 32nd of an edge are not joined", "[features][unit]") {
  for (const double thickness : {.004, .001}) {
    FeatureMesh mesh = weld_for_features(cylinder(48, 1, thickness));
    const double volume = volume_of(mesh);
    remove_slivers(mesh, frame_of(mesh), {}, .2, context);
    CHECK(is_closed(mesh));
    CHECK(volume_of(mesh) == Approx(volume).epsilon(.01));
  }
}

TEST_CASE("slivers: narrow facets of a round part are no strips", "[features][unit]") {
  FeatureMesh mesh = weld_for_features(cylinder(2000, 1, 1));
  const auto triangles = mesh.triangles;
  CHECK_FALSE(remove_slivers(mesh, frame_of(mesh), {}, .2, context));
  CHECK(mesh.triangles == triangles);
}

TEST_CASE("slivers: a mesh without any is left as it is", "[features][unit]") {
  FeatureMesh ball = weld_for_features(shapes::sphere({0, 0, 0}, 1, 24));
  const auto triangles = ball.triangles;
  CHECK_FALSE(remove_slivers(ball, frame_of(ball), {}, 0, context));
  CHECK(ball.triangles == triangles);
}

TEST_CASE("slivers: thin triangles of a long flat strip have its normal, not that of what it ends at",
          "[features][unit]") {
  // Slats under a beam: the beam's side is a fan of triangles, the farther the thinner.
  TriangleSoup soup;
  constexpr uint32_t n = 40;
  constexpr double length = 400;
  for (const double y : {0., 1.})
    for (const double z : {0., 1.})
      for (uint32_t i = 0; i <= n; ++i)
        if (z == 0 || i == 0 || i == n) soup.vertices.push_back({length * i / n, y, z});
  const auto below = [&](uint32_t side, uint32_t i) { return side * (n + 3) + i; };
  const auto above = [&](uint32_t side, bool is_end) { return side * (n + 3) + n + 1 + is_end; };
  for (uint32_t i = 0; i < n; ++i) {
    shapes::add_triangle(soup, below(0, i), below(0, i + 1), above(0, false));
    shapes::add_triangle(soup, below(1, i + 1), below(1, i), above(1, false));
    shapes::add_triangle(soup, below(0, i), below(1, i), below(1, i + 1));
    shapes::add_triangle(soup, below(0, i), below(1, i + 1), below(0, i + 1));
  }
  shapes::add_triangle(soup, above(0, false), below(0, n), above(0, true));
  shapes::add_triangle(soup, above(1, false), above(1, true), below(1, n));
  shapes::add_triangle(soup, above(0, false), above(0, true), above(1, true));
  shapes::add_triangle(soup, above(0, false), above(1, true), above(1, false));
  shapes::add_triangle(soup, below(0, 0), above(0, false), above(1, false));
  shapes::add_triangle(soup, below(0, 0), above(1, false), below(1, 0));
  shapes::add_triangle(soup, below(0, n), above(1, true), above(0, true));
  shapes::add_triangle(soup, below(0, n), below(1, n), above(1, true));
  FeatureMesh mesh = weld_for_features(soup);
  mesh.rounding_world = .05 / 16;  // half of the fan is thinner than .05
  CHECK(counts_of(find_curves(mesh, {CreaseMode::threshold, 40, .5})) == Counts{12, 0, 0, 0, 8});
}
