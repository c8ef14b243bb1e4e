// Lines on a mesh: they become edges, and the surface stays what it was.
#include <cmath>

#include "features/mesh/embed_lines.h"
#include "features/mesh/mesh_edges.h"
#include "features/mesh/weld_for_features.h"
#include "geometry/triangle_grid.h"
#include "geometry/world_vector.h"
#include "support/catch.h"
#include "support/shapes.h"
#include "voxel/random.h"

using namespace isoshell;

namespace {

constexpr double kTolerance = 1e-4;

/// The nearest points of the mesh, joined as the segments say.
LinesOnMesh lines_on(const FeatureMesh& mesh, const std::vector<WorldPoint>& points,
                     std::vector<std::array<uint32_t, 2>> segments) {
  const TriangleGrid grid(mesh.vertices, mesh.triangles);
  LinesOnMesh lines{{}, std::move(segments)};
  for (const WorldPoint& p : points) {
    const MeshPoint on = grid.nearest(p);
    const auto& [a, b, c] = mesh.triangles[on.triangle];
    const WorldPoint& o = mesh.vertices[a];
    lines.points.push_back({on.triangle, o + on.b_part * (mesh.vertices[b] - o) + on.c_part * (mesh.vertices[c] - o)});
  }
  return lines;
}

double area_of(const FeatureMesh& mesh) {
  double area = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    area += triangle_area(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]);
  return area;
}

double length_of(const FeatureMesh& mesh, const EdgeList& edges) {
  double sum = 0;
  for (const auto& [u, v] : edges) sum += length(mesh.vertices[v] - mesh.vertices[u]);
  return sum;
}

/// The same closed surface, whose edges the lines are.
void check_mesh_of(const MeshWithLines& made, const FeatureMesh& before) {
  CHECK(area_of(made.mesh) == Approx(area_of(before)).epsilon(1e-9));
  CHECK(made.mesh.source_face.size() == made.mesh.triangles.size());
  const MeshEdges edges = find_mesh_edges(made.mesh);
  for (const FeatureEdge& e : edges.edges) REQUIRE(e.use == EdgeUse::inner);
  for (const auto& line : made.edges)
    CHECK(std::any_of(edges.edges.begin(), edges.edges.end(), [&](const FeatureEdge& e) { return e.end == line; }));
  CHECK(made.mesh.vertices.size() + made.mesh.triangles.size() - edges.count() ==
        before.vertices.size() + before.triangles.size() - find_mesh_edges(before).count());
}

}  // namespace

TEST_CASE("lines: those on edges of the mesh are these edges, and nothing is cut", "[lines][unit]") {
  const FeatureMesh mesh = weld_for_features(shapes::sphere({0, 0, 0}, 1, 32));
  std::vector<WorldPoint> equator;
  std::vector<std::array<uint32_t, 2>> segments;
  for (uint32_t i = 0; i < 32; ++i) {
    const double turn = 6.283185307179586 * i / 32;
    equator.push_back({std::cos(turn), std::sin(turn), 0});
    segments.push_back({i, (i + 1) % 32});
  }
  const MeshWithLines made = embed_lines(mesh, lines_on(mesh, equator, segments), {}, kTolerance);
  CHECK(made.lost_segments.empty());
  CHECK(made.edges.size() == 32);
  CHECK(made.mesh.vertices.size() == mesh.vertices.size());
  CHECK(made.mesh.triangles == mesh.triangles);
}

TEST_CASE("lines: one straight line may run along many edges", "[lines][unit]") {
  TriangleSoup soup = shapes::box({0, 0, 0}, {1, 1, 1});
  FeatureMesh mesh = weld_for_features(soup);
  const LinesOnMesh quarters =
      lines_on(mesh, {{0, 0, 0}, {.25, 0, 0}, {.5, 0, 0}, {.75, 0, 0}}, {{0, 1}, {1, 2}, {2, 3}});
  const FeatureMesh cut = embed_lines(mesh, quarters, {}, kTolerance).mesh;
  CHECK(cut.vertices.size() == 11);
  const MeshWithLines made = embed_lines(cut, lines_on(cut, {{0, 0, 0}, {1, 0, 0}}, {{0, 1}}), {}, kTolerance);
  CHECK(made.edges.size() == 4);
  CHECK(made.mesh.vertices.size() == 11);
  CHECK(length_of(made.mesh, made.edges) == Approx(1));
}

TEST_CASE("lines: one from face to face goes over the edge between them", "[lines][unit]") {
  const FeatureMesh mesh = weld_for_features(shapes::box({0, 0, 0}, {1, 1, 1}));
  const MeshWithLines made = embed_lines(mesh, lines_on(mesh, {{.3, .4, 1}, {1, .45, .7}}, {{0, 1}}), {}, kTolerance);
  check_mesh_of(made, mesh);
  CHECK(made.lost_segments.empty());
  double shortest = 2;  // of the plane's way: through (1, y, 1)
  for (int i = 0; i <= 1000; ++i) {
    const double y = i / 1000.;
    shortest = std::min(shortest, length(WorldPoint{.7, y - .4, 0}) + length(WorldPoint{0, .45 - y, -.3}));
  }
  CHECK(length_of(made.mesh, made.edges) < 1.02 * shortest);
}

TEST_CASE("lines: a great circle through any points lies in its plane", "[lines][unit]") {
  const FeatureMesh mesh = weld_for_features(shapes::sphere({0, 0, 0}, 1, 40));
  const WorldPoint u{.6, .48, .64}, v = [&] {
    const WorldPoint w = cross(u, {0, 0, 1});
    return 1 / length(w) * w;
  }();
  std::vector<WorldPoint> circle;
  std::vector<std::array<uint32_t, 2>> segments;
  for (uint32_t i = 0; i < 24; ++i) {
    const double turn = 6.283185307179586 * i / 24;
    circle.push_back(std::cos(turn) * u + std::sin(turn) * v);
    segments.push_back({i, (i + 1) % 24});
  }
  const MeshWithLines made = embed_lines(mesh, lines_on(mesh, circle, segments), {}, kTolerance);
  check_mesh_of(made, mesh);
  CHECK(made.lost_segments.empty());
  const WorldPoint axis = cross(u, v);
  for (const auto& edge : made.edges)
    for (const uint32_t end : edge) CHECK(std::abs(dot(made.mesh.vertices[end], axis)) < .003);
  CHECK(length_of(made.mesh, made.edges) == Approx(6.283185307179586).epsilon(.01));
}

TEST_CASE("lines: two that cross have a vertex there, and edges that are followed are split", "[lines][unit]") {
  const FeatureMesh mesh = weld_for_features(shapes::box({0, 0, 0}, {1, 1, 1}));
  const LinesOnMesh cross = lines_on(
      mesh, {{.2, .2, 1}, {.8, .7, 1}, {.2, .7, 1}, {.8, .2, 1}, {.5, .5, 1}, {.5, -0., .5}}, {{0, 1}, {2, 3}, {4, 5}});
  EdgeList rim;
  for (const FeatureEdge& e : find_mesh_edges(mesh).edges)
    if (length(mesh.vertices[e.end[1]] - mesh.vertices[e.end[0]]) < 1.1) rim.push_back(e.end);
  REQUIRE(rim.size() == 12);
  const MeshWithLines made = embed_lines(mesh, cross, {rim}, kTolerance);
  check_mesh_of(made, mesh);
  CHECK(made.lost_segments.empty());
  CHECK(made.followed.at(0).size() == 13);
  CHECK(length_of(made.mesh, made.followed[0]) == Approx(12));
  CHECK(std::any_of(made.mesh.vertices.begin(), made.mesh.vertices.end(), [](const WorldPoint& p) {
    return length(p - WorldPoint{.5, .45, 1}) < 1e-6;
  }));
}

TEST_CASE("lines: a segment over a hole is lost, and the others stay", "[lines][unit]") {
  TriangleSoup two = shapes::together(shapes::box({0, 0, 0}, {1, 1, 1}), shapes::box({2, 0, 0}, {3, 1, 1}));
  const FeatureMesh mesh = weld_for_features(two);
  const MeshWithLines made =
      embed_lines(mesh, lines_on(mesh, {{.3, .3, 1}, {.6, .4, 1}, {2.5, .5, 1}}, {{0, 1}, {1, 2}}), {}, kTolerance);
  CHECK(made.lost_segments == std::vector<size_t>{1});
  CHECK(length_of(made.mesh, made.edges) == Approx(std::sqrt(.1)));
}

TEST_CASE("lines: random ones leave a closed surface of the same area", "[lines][unit]") {
  for (uint64_t seed = 0; seed < 8; ++seed) {
    INFO("seed " << seed);
    const auto part = [&](uint64_t i) { return double(random_bits(seed, i) >> 11) / 9007199254740992.0; };
    const FeatureMesh mesh =
        weld_for_features(seed % 2 == 0 ? shapes::torus(2, .7, 24, 12) : shapes::box({0, 0, 0}, {1, 2, 1}));
    std::vector<WorldPoint> points;
    std::vector<std::array<uint32_t, 2>> segments;
    for (uint32_t i = 0; i < 20; ++i) {
      points.push_back({6 * part(3 * i) - 3, 6 * part(3 * i + 1) - 3, 2 * part(3 * i + 2) - 1});
      if (i > 0) segments.push_back({i - 1, i});
    }
    const MeshWithLines made = embed_lines(mesh, lines_on(mesh, points, segments), {}, kTolerance);
    check_mesh_of(made, mesh);
    for (const auto& [a, b, c] : made.mesh.triangles)
      CHECK(triangle_area(made.mesh.vertices[a], made.mesh.vertices[b], made.mesh.vertices[c]) > 0);
  }
}
