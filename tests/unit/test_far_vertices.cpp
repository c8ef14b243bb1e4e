// Vertices far away from all others, on shapes where it is known which these are.
#include "isoshell/memory_estimate.h"
#include "isoshell/mesh_topology.h"
#include "isoshell/remesh.h"
#include "repair/holes/far_vertices.h"
#include "support/catch.h"
#include "support/shapes.h"

using namespace isoshell;

namespace {

constexpr double kEdge = .5;  // longer than the foot of one vertex of the ball, shorter than the ball

TriangleSoup ball_with(std::initializer_list<std::pair<uint32_t, WorldPoint>> moved) {
  TriangleSoup ball = shapes::sphere({0, 0, 0}, 1, 32);
  for (const auto& [v, to] : moved) ball.vertices[v] = to;
  return ball;
}

struct PulledBack {
  std::optional<TriangleSoup> soup;
  FarVertexReport report;
};

PulledBack pulled_back(const TriangleSoup& soup, double edge_world = kEdge) {
  std::optional<TriangleSoup> made = repair::pull_back_far_vertices(soup, [&](double) { return edge_world; });
  const FarVertexReport report = made ? made->far : FarVertexReport{};
  return {std::move(made), report};
}

/// Almost the ball that it was.
void check_ball(const TriangleSoup& soup) {
  for (const auto& t : soup.triangles)
    for (const uint32_t v : t) CHECK(std::abs(soup.vertices[v].x) <= 1);
  CHECK(volume(soup) == Approx(volume(ball_with({}))).epsilon(.02));
}

}  // namespace

TEST_CASE("far vertices: one at any distance goes back to the middle of its neighbours", "[repair]") {
  for (const double distance : {100., 1e3, 1e5, 1e15, 1e100}) {
    const PulledBack made = pulled_back(ball_with({{200, {distance, 0, 0}}}));
    REQUIRE(made.soup);
    CHECK(made.report.vertices == 1);
    CHECK(made.report.distance_world == Approx(distance).epsilon(.02));
    CHECK(made.report.farthest.x == distance);
    check_ball(*made.soup);
  }
}

TEST_CASE("far vertices: neighbours that are far away together become one, others at other distances go back alone",
          "[repair]") {
  const TriangleSoup ball = ball_with({});
  const auto& face = ball.triangles[ball.triangles.size() / 2];
  const PulledBack edge = pulled_back(ball_with({{face[0], {1e5, 0, 0}}, {face[1], {1e5, .5, 0}}}), 2 * kEdge);
  REQUIRE(edge.soup);
  CHECK(edge.report.vertices == 2);
  check_ball(*edge.soup);
  const PulledBack three = pulled_back(ball_with({{100, {1e5, 0, 0}}, {300, {0, -1e8, 0}}, {400, {0, 0, 200}}}));
  REQUIRE(three.soup);
  CHECK(three.report.vertices == 3);
  check_ball(*three.soup);
}

TEST_CASE("far vertices: spikes of usual lengths, needles that edges can follow, and surfaces of needles stay",
          "[repair]") {
  CHECK_FALSE(pulled_back(ball_with({})).soup);
  CHECK_FALSE(pulled_back(ball_with({{200, {30, 0, 0}}})).soup);          // an antenna
  CHECK_FALSE(pulled_back(ball_with({{200, {1e5, 0, 0}}}), .01).soup);    // edges are shorter than its foot
  CHECK_FALSE(pulled_back(shapes::box({0, 0, 0}, {1000, .1, .1})).soup);  // a rod
  TriangleSoup cone = ball_with({});
  for (WorldPoint& p : cone.vertices)
    if (p.x > -.5) p = {1e4, 0, 0};
  CHECK_FALSE(pulled_back(cone, 1e3).soup);
  CHECK_FALSE(pulled_back({}).soup);
}

TEST_CASE("far vertices: a corner of one of two cubes that share a wall goes back, with the regions there",
          "[repair]") {
  TriangleSoup cubes = shapes::together(shapes::box({0, 0, 0}, {1, 1, 1}), shapes::box({1, 0, 0}, {2, 1, 1}));
  for (WorldPoint& p : cubes.vertices)
    if (p.x == 0 && p.y == 1 && p.z == 1) p.y = 65536;
  cubes.regions.labels.assign(cubes.triangles.size(), {1, 0});
  const PulledBack made = pulled_back(cubes, 30);
  REQUIRE(made.soup);
  CHECK(made.report.vertices == 1);
  CHECK(made.soup->regions.labels.size() == made.soup->triangles.size());
  for (const WorldPoint& p : made.soup->vertices) CHECK(p.y <= 1);
}

TEST_CASE("far vertices: a wide part with few faces beside a small one with many stays", "[repair]") {
  TriangleSoup plate = shapes::sphere({0, 0, 0}, .004, 64);  // a boss, of whose lowest ring the corners of a plate hang
  const uint32_t first = uint32_t(plate.vertices.size());
  for (const WorldPoint& p : {WorldPoint{.5, .5, 0}, {-.5, .5, 0}, {-.5, -.5, 0}, {.5, -.5, 0}})
    plate.vertices.push_back(p);
  plate.triangles.push_back({first, first + 1, 0});
  plate.triangles.push_back({first, first + 2, first + 1});
  plate.triangles.push_back({first, first + 3, first + 2});
  CHECK_FALSE(pulled_back(plate, .0153).soup);
}

TEST_CASE("far vertices: what was pulled back is not looked at again", "[repair]") {
  const PulledBack made = pulled_back(ball_with({{200, {1e5, 0, 0}}}));
  REQUIRE(made.soup);
  CHECK_FALSE(pulled_back(*made.soup).soup);
  Context context;
  CHECK(prepare(*made.soup, {}, context).report().input.far.vertices == 1);
}

TEST_CASE("far vertices: of an open surface, too, and that is said", "[repair][run]") {
  TriangleSoup open = ball_with({{200, {1e5, 0, 0}}});
  open.triangles.erase(open.triangles.begin());
  RemeshOptions options;
  options.vertices = 200;
  Context context;
  CHECK(remesh(open, options, context).report.input.far.vertices == 1);
}

TEST_CASE("far vertices: parts far away stay, as no face says where they belong", "[repair]") {
  const TriangleSoup far = shapes::sphere({1e5, 0, 0}, .01, 8);
  CHECK_FALSE(pulled_back(shapes::together(ball_with({}), far)).soup);
}

TEST_CASE("far vertices: the mesh of a ball with one is that of a ball, and says what was done", "[repair][run]") {
  RemeshOptions options;
  options.vertices = 200;
  Context context;
  const RemeshResult result = remesh(ball_with({{200, {1e5, 0, 0}}}), options, context);
  CHECK(result.mesh.vertices.size() == 200);
  CHECK(check_mesh(result.mesh).is_closed_manifold());
  CHECK(result.report.input.far.vertices == 1);
  for (const WorldPoint& p : result.mesh.vertices) CHECK(std::abs(p.x) < 1.1);
}

TEST_CASE("far vertices: an estimate is that of the surface without them", "[repair][run]") {
  RemeshOptions options;
  options.edge_length_world = kEdge;
  Context context;
  const TriangleSoup ball = ball_with({{200, {1e5, 0, 0}}});
  const RunEstimate estimate = estimate_run(ball, measure_topology(ball, context).topology, options);
  const RemeshResult result = remesh(ball, options, context);
  CHECK(estimate.voxel_size_world == result.report.grid.frame.voxel_size);
  CHECK(estimate.vertices == int64_t(result.mesh.vertices.size()));
}
