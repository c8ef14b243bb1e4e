// Runs that keep lines of the user's: they become edges of the result, wherever they lie on the surface.
#include <cmath>

#include "geometry/world_vector.h"
#include "isoshell/advanced/digest.h"
#include "isoshell/error.h"
#include "isoshell/mesh_topology.h"
#include "isoshell/quality.h"
#include "isoshell/remesh.h"
#include "support/catch.h"
#include "support/shapes.h"
#include "support/test_context.h"

using namespace isoshell;

namespace {

RemeshOptions keeping(const Polylines& lines, int64_t vertices, Features::Creases creases = Features::Creases::off) {
  RemeshOptions options;
  options.vertices = vertices;
  options.features.creases = creases;
  options.features.lines = std::make_shared<Polylines>(lines);
  return options;
}

Polylines ring(const std::vector<WorldPoint>& points) {
  Polylines lines{points, {}, "", {}};
  for (uint32_t i = 0; i < points.size(); ++i) lines.segments.push_back({i, uint32_t((i + 1) % points.size())});
  return lines;
}

/// Sixty points of a tilted great circle of the unit sphere, and its axis.
struct Circle {
  Polylines lines;
  WorldPoint axis;
};
Circle great_circle() {
  const WorldPoint u{.6, .48, .64}, w = cross(u, {0, 0, 1}), v = 1 / length(w) * w;
  std::vector<WorldPoint> points;
  for (int i = 0; i < 60; ++i) {
    const double turn = 6.283185307179586 * i / 60;
    points.push_back(std::cos(turn) * u + std::sin(turn) * v);
  }
  return {ring(points), cross(u, v)};
}

void check_valid(const RemeshResult& result, int64_t vertices) {
  CHECK(check_mesh(result.mesh).is_closed_manifold());
  CHECK(result.report.optimize.self_intersections == 0);
  CHECK(int64_t(result.mesh.vertices.size()) == vertices);
  CHECK(result.report.features.kept);
  CHECK(result.report.features.lost.empty());
}

/// Length of the result's edges both of whose ends are in a set.
template <class IsOn>
double length_where(const TriangleMesh& mesh, IsOn is_on) {
  double sum = 0;
  for (const auto& t : mesh.triangles)
    for (size_t i = 0; i < 3; ++i) {
      const WorldPoint &a = mesh.vertices[t[i]], &b = mesh.vertices[t[(i + 1) % 3]];
      if (t[i] < t[(i + 1) % 3] && is_on(a) && is_on(b)) sum += length(b - a);
    }
  return sum;
}

}  // namespace

TEST_CASE("lines: a great circle on a sphere becomes edges of the result", "[lines]") {
  TestContext context;
  const Circle circle = great_circle();
  const RemeshResult result = remesh(shapes::sphere({0, 0, 0}, 1, 96), keeping(circle.lines, 1500), context);
  check_valid(result, 1500);
  CHECK(result.report.features.lines == 1);
  CHECK(result.report.features.curves == 1);
  CHECK(result.report.features.patches == 2);
  const double fine = result.report.grid.frame.voxel_size / 32;
  const double on =
      length_where(result.mesh, [&](const WorldPoint& p) { return std::abs(dot(p, circle.axis)) < fine; });
  CHECK(on == Approx(6.283185307179586).epsilon(.01));
  CHECK(measure_quality(result.mesh).theta_min_deg > 30);
  CHECK(measure_quality(result.mesh).q_avg > .95);

  double marked = 0;
  for (const MeshCurveEdge& e : result.mesh.features.curve_edges) {
    for (const uint32_t v : e.vertex) CHECK(std::abs(dot(result.mesh.vertices[v], circle.axis)) < fine);
    marked += length(result.mesh.vertices[e.vertex[1]] - result.mesh.vertices[e.vertex[0]]);
  }
  CHECK(marked == Approx(on).epsilon(1e-3));
  CHECK(result.report.features.segments == int64_t(result.mesh.features.curve_edges.size()));
}

TEST_CASE("lines: patches lie on one side of a line each", "[lines]") {
  TestContext context;
  const Circle circle = great_circle();
  const RemeshResult result = remesh(shapes::sphere({0, 0, 0}, 1, 96), keeping(circle.lines, 1000), context);
  REQUIRE(result.mesh.features.patch.size() == result.mesh.triangles.size());
  int above[2] = {0, 0}, below[2] = {0, 0};
  for (size_t t = 0; t < result.mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = result.mesh.triangles[t];
    const WorldPoint middle = result.mesh.vertices[a] + result.mesh.vertices[b] + result.mesh.vertices[c];
    REQUIRE(result.mesh.features.patch[t] < 2);
    ++(dot(middle, circle.axis) > 0 ? above : below)[result.mesh.features.patch[t]];
  }
  CHECK(std::min(above[0], above[1]) == 0);
  CHECK(std::min(below[0], below[1]) == 0);
}

TEST_CASE("lines: those of a box meet its creases, and are edges beside them", "[lines]") {
  TestContext context;
  const Polylines cross{{{-1, -1, 1}, {1, 1, 1}, {-1, 0, 1}, {1, 0, 1}, {1, 0, -1}}, {{0, 1}, {2, 3}, {3, 4}}, "", {}};
  const RemeshResult result =
      remesh(shapes::box({-1, -1, -1}, {1, 1, 1}), keeping(cross, 1500, Features::Creases::automatic), context);
  check_valid(result, 1500);
  CHECK(result.report.features.lines >= 4);
  const double fine = result.report.grid.frame.voxel_size / 32;
  const auto on_top = [&](const WorldPoint& p) { return std::abs(p.z - 1) < fine; };
  CHECK(length_where(result.mesh, [&](const WorldPoint& p) { return on_top(p) && std::abs(p.x - p.y) < fine; }) ==
        Approx(2 * std::sqrt(2.)).epsilon(1e-3));
  CHECK(length_where(result.mesh, [&](const WorldPoint& p) { return on_top(p) && std::abs(p.y) < fine; }) ==
        Approx(2).epsilon(1e-3));
  CHECK(length_where(result.mesh, [&](const WorldPoint& p) {
          return std::abs(p.x - 1) < fine && std::abs(p.y) < fine;
        }) == Approx(2).epsilon(1e-3));
}

TEST_CASE("lines: an open one ends in the middle of a face", "[lines]") {
  TestContext context;
  const Polylines slit{{{-.5, .2, 1}, {.5, -.1, 1}}, {{0, 1}}, "", {}};
  const RemeshResult result =
      remesh(shapes::box({-1, -1, -1}, {1, 1, 1}), keeping(slit, 1200, Features::Creases::automatic), context);
  check_valid(result, 1200);
  double marked = 0;
  for (const MeshCurveEdge& e : result.mesh.features.curve_edges) {
    const WorldPoint &a = result.mesh.vertices[e.vertex[0]], &b = result.mesh.vertices[e.vertex[1]];
    if (std::abs(a.x) < .9 && std::abs(b.x) < .9 && a.z > .99 && b.z > .99 && std::abs(a.y) < .9)
      marked += length(b - a);
  }
  CHECK(marked == Approx(std::sqrt(1.09)).epsilon(.01));
}

TEST_CASE("lines: what is off the surface is named, and an error where nothing is on it", "[lines]") {
  TestContext context;
  Polylines lines{{{-.5, .2, 1}, {.5, -.1, 1}, {.5, -.1, 2}}, {{0, 1}, {1, 2}}, "marks.obj", {7, 9}};
  const TriangleSoup cube = shapes::box({-1, -1, -1}, {1, 1, 1});
  const RemeshResult result = remesh(cube, keeping(lines, 800), context);
  CHECK(result.report.features.kept);
  REQUIRE(result.report.features.lost.size() == 1);
  const LostCurve& lost = result.report.features.lost[0];
  CHECK(lost.index == 1);
  CHECK(lost.kind == "line");
  CHECK(lost.length_world == 1);
  CHECK(lost.reason.find("it is 1 from the surface, more than half an edge length") == 0);
  REQUIRE(result.report.warnings.size() == 1);
  CHECK(result.report.warnings[0].find("marks.obj, line 9: it is 1 from") != std::string::npos);

  lines.segments = {{1, 2}};
  lines.lines = {9};
  CHECK_THROWS_AS(remesh(cube, keeping(lines, 800), context), Error);
  lines.segments = {{1, 3}};
  CHECK_THROWS_AS(remesh(cube, keeping(lines, 800), context), Error);
}

TEST_CASE("lines: without creases a box keeps the given lines only", "[lines]") {
  TestContext context;
  const RemeshResult result = remesh(shapes::box({-1, -1, -1}, {1, 1, 1}),
                                     keeping(ring({{-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}}), 1000), context);
  check_valid(result, 1000);
  CHECK(result.report.features.curves == result.report.features.lines);
  CHECK(result.report.features.patches == 2);
}

TEST_CASE("lines: the bytes are the same for any number of threads", "[lines]") {
  TestContext one, more;
  one.threads = 1;
  more.threads = 3;
  const Circle circle = great_circle();
  const TriangleSoup soup = shapes::sphere({0, 0, 0}, 1, 64);
  CHECK(digest(remesh(soup, keeping(circle.lines, 700), one).mesh) ==
        digest(remesh(soup, keeping(circle.lines, 700), more).mesh));
}

TEST_CASE("interfaces: parts that share a wall become one solid, and the ring around it edges", "[lines][walls]") {
  TestContext context;
  const TriangleSoup parts = shapes::together(shapes::box({0, 0, 0}, {1, 1, 1}), shapes::box({1, 0, 0}, {2, 1, 1}));
  TriangleSoup single = parts;  // the wall once
  single.triangles.erase(single.triangles.begin() + 12, single.triangles.begin() + 14);
  for (const TriangleSoup& soup : {parts, single}) {
    RemeshOptions options;
    options.vertices = 1000;
    const RemeshResult result = remesh(soup, options, context);
    check_valid(result, 1000);
    CHECK(result.report.features.lines == 4);
    CHECK(result.report.features.curves == 20);
    const double fine = result.report.grid.frame.voxel_size / 32;
    CHECK(length_where(result.mesh, [&](const WorldPoint& p) { return std::abs(p.x - 1) < fine; }) ==
          Approx(4).epsilon(1e-3));
    REQUIRE_FALSE(result.report.warnings.empty());
    CHECK(result.report.warnings[0].find("2 triangles between parts left out, solid is on both sides; 4 edges") == 0);

    options.features.creases = Features::Creases::off;
    CHECK(remesh(soup, options, context).report.features.curves == 0);
  }
}

TEST_CASE("interfaces: edges of three sheets are no edges of a manifold, and the run says where they are",
          "[lines][walls]") {
  TestContext context;
  TriangleSoup tee;
  tee.vertices = {{0, 0, 0}, {0, 4, 0}, {4, 0, 0}, {4, 4, 0}, {-4, 0, 0}, {-4, 4, 0}, {0, 0, 4}, {0, 4, 4}};
  for (const uint32_t page : {2u, 4u, 6u}) {
    tee.triangles.push_back({0, page, page + 1});
    tee.triangles.push_back({0, page + 1, 1});
  }
  RemeshOptions options;
  options.vertices = 800;
  const RemeshResult result = remesh(tee, options, context);
  CHECK(check_mesh(result.mesh).is_closed_manifold());
  int said = 0;
  for (const std::string& text : result.report.warnings)
    said += text.find("1 edge of more than two faces") == 0 && text.find("the first at 0 0 0") != std::string::npos;
  CHECK(said == 1);
}
