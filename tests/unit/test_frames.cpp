// Names of frames, where vertices go from frame to frame, and how steady they are.
#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/world_vector.h"
#include "isoshell/error.h"
#include "isoshell/previous_frame.h"
#include "isoshell/run/sequence.h"
#include "support/catch.h"
#include "support/mesh_files.h"
#include "support/refusals.h"
#include "support/shapes.h"
#include "support/test_context.h"

using namespace isoshell;

namespace {

double apart(WorldPoint a, WorldPoint b) { return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z); }

/// Turns by a quarter around z, stretches and shifts: exact in doubles.
WorldPoint moved(WorldPoint p) { return {3 - p.y, 2 * p.x, p.z + 7}; }

TriangleSoup moved(TriangleSoup soup) {
  for (WorldPoint& p : soup.vertices) p = moved(p);
  return soup;
}

/// Squares of cells, one from `lo` at its height that faces up, one to `hi` at its height that faces down.
TriangleSoup facing_sheets(WorldPoint lo, WorldPoint hi, uint32_t cells) {
  const auto sheet = [&](double z) {
    TriangleSoup s;
    const auto along = [&](double from, double to, uint32_t i) { return from + i * (to - from) / cells; };
    for (uint32_t j = 0; j <= cells; ++j)
      for (uint32_t i = 0; i <= cells; ++i) s.vertices.push_back({along(lo.x, hi.x, i), along(lo.y, hi.y, j), z});
    for (uint32_t j = 0; j < cells; ++j)
      for (uint32_t i = 0; i < cells; ++i) {
        const uint32_t a = j * (cells + 1) + i, c = a + cells + 2;
        shapes::add_triangle(s, a, a + 1, c);
        shapes::add_triangle(s, a, c, c - 1);
      }
    return s;
  };
  return shapes::together(sheet(lo.z), shapes::inside_out(sheet(hi.z)));
}

std::string refusal(const std::string& pattern) {
  return message_of(ErrorCode::usage, [&] { path_of_frame(pattern, 1); });
}

}  // namespace

TEST_CASE("frames: a pattern has one place for the number, in either form", "[frames]") {
  CHECK(path_of_frame("a.####.obj", 7) == "a.0007.obj");
  CHECK(path_of_frame("a.#.obj", 1234) == "a.1234.obj");
  CHECK(path_of_frame("d/a%04d.ply", 12345) == "d/a12345.ply");
  CHECK(path_of_frame("%d/a.ply", 3) == "3/a.ply");
  CHECK(path_of_frame("50%/a.##.ply", 3) == "50%/a.03.ply");
  CHECK(contains(refusal("a.obj"), "no place"));
  CHECK(contains(refusal("##/a.##.obj"), "more than one place"));
}

TEST_CASE("frames: ranges are read whole, and refused with what they may be", "[frames]") {
  const FrameRange every = parse_frames("1-240"), second = parse_frames("10-20x2"), one = parse_frames("7");
  CHECK((every.first == 1 && every.last == 240 && every.step == 1));
  CHECK((second.first == 10 && second.last == 20 && second.step == 2));
  CHECK((one.first == 7 && one.last == 7));
  for (const char* text :
       {"", "a", "5-", "-5", "9-5", "1-5x0", "1-5x", "1 - 5", "1-5y2", "1-10000001", "99999999999999999999"})
    CHECK_THROWS_AS(parse_frames(text), Error);
}

TEST_CASE("frames: a surface whose vertices have velocities takes points along", "[frames]") {
  const TriangleSoup ball = shapes::sphere({1, 2, 3}, 5, 24);
  const auto spin = [](WorldPoint p) { return WorldPoint{-0.1 * (p.y - 2), 0.1 * (p.x - 1), 0.02}; };
  std::vector<WorldPoint> velocities;
  for (const WorldPoint& p : ball.vertices) velocities.push_back(spin(p));
  const std::vector<WorldPoint> found = velocity_on(ball, velocities)->velocities_at(ball.vertices);
  for (size_t v = 0; v < found.size(); ++v) CHECK(std::sqrt(distance_sq(found[v], velocities[v])) < 1e-12);
  const WorldPoint off{1 + 3.3, 2, 3 + 3.3}, there = velocity_on(ball, velocities)->velocities_at({off})[0];
  CHECK(std::sqrt(distance_sq(there, spin({1 + 5 / std::sqrt(2), 2, 3}))) < 0.02);
  velocities[0].y = std::numeric_limits<double>::quiet_NaN();
  CHECK(carry_with_velocity({ball.vertices[0]}, *velocity_on(ball, velocities))[0].z == ball.vertices[0].z);
  velocities[0].y = std::numeric_limits<double>::infinity();
  CHECK_THROWS_AS(velocity_on(ball, velocities), Error);
  velocities.pop_back();
  CHECK_THROWS_AS(velocity_on(ball, velocities), Error);
}

TEST_CASE("frames: points go along with the triangles under them", "[frames]") {
  CpuContext context;
  const TriangleSoup before = shapes::sphere({1, 2, 3}, 5, 24), now = moved(before);
  TriangleMesh mesh = mesh_of(before);
  for (const auto& t : before.triangles) {
    const WorldPoint &a = before.vertices[t[0]], &b = before.vertices[t[1]], &c = before.vertices[t[2]];
    mesh.vertices.push_back({(a.x + b.x + 2 * c.x) / 4, (a.y + b.y + 2 * c.y) / 4, (a.z + b.z + 2 * c.z) / 4});
  }
  const std::vector<WorldPoint> carried = carry_with_triangles(mesh, before, now, context);
  double farthest = 0;
  for (size_t i = 0; i < carried.size(); ++i) farthest = std::max(farthest, apart(carried[i], moved(mesh.vertices[i])));
  CHECK(farthest < 1e-12);
  TriangleSoup other = now;
  std::swap(other.triangles[0][0], other.triangles[0][1]);
  CHECK_FALSE(have_same_triangles(before, other));
  CHECK_THROWS_AS(carry_with_triangles(mesh, before, other, context), Error);
}

TEST_CASE("frames: vertices go along with the wall that faces their way, though another one is nearer", "[frames]") {
  TriangleMesh mesh = mesh_of(facing_sheets({1, 1, .001}, {9, 9, .009}, 30));
  for (size_t v = 0; v < mesh.vertices.size(); v += 3)
    mesh.vertices[v].z = .01 - mesh.vertices[v].z;  // to the other wall
  TriangleSoup before = facing_sheets({0, 0, 0}, {10, 10, .01}, 7), now = before;
  const size_t half = mesh.vertices.size() / 2;
  const auto goes = [&](size_t i, WorldPoint p) { return i < half ? moved(p) : WorldPoint{p.x, p.y + 1, p.z + 20}; };
  for (size_t v = 0; v < now.vertices.size(); ++v)
    now.vertices[v] = v < now.vertices.size() / 2 ? moved(now.vertices[v]) : goes(half, now.vertices[v]);
  for (const bool turned : {false, true}) {
    if (turned) before = shapes::inside_out(before), now = shapes::inside_out(now);
    for (const int threads : {1, 3}) {
      CpuContext context;
      context.threads = threads;
      const std::vector<WorldPoint> carried = carry_with_triangles(mesh, before, now, context);
      double farthest = 0;
      for (size_t i = 0; i < carried.size(); ++i)
        farthest = std::max(farthest, apart(carried[i], goes(i, mesh.vertices[i])));
      CHECK(farthest < 1e-12);
    }
  }
}

TEST_CASE("frames: over faces that are turned inside out vertices keep their place, nearly", "[frames]") {
  CpuContext context;
  const TriangleMesh mesh = mesh_of(facing_sheets({1.07, 1.12, .001}, {8.9, 8.8, 5}, 8));
  TriangleSoup before = facing_sheets({0, 0, 0}, {10, 10, 5.001}, 30);
  for (size_t t = 0; t < before.triangles.size(); t += 5) std::swap(before.triangles[t][0], before.triangles[t][1]);
  const std::vector<WorldPoint> carried = carry_with_triangles(mesh, before, moved(before), context);
  for (size_t i = 0; i < carried.size(); ++i) CHECK(apart(carried[i], moved(mesh.vertices[i])) < .002);  // their height
}

TEST_CASE("frames: on another surface vertices stay on their side of a thin wall", "[frames]") {
  CpuContext context;
  const TriangleSoup now = shapes::box({0, 0, 0.15}, {10, 10, 0.35});
  const TriangleMesh mesh =
      mesh_of(shapes::box({4, 4, 0}, {6, 6, 0.2}));  // whose upper side is nearer to the lower one
  TriangleMesh sides{mesh.vertices, {}};
  for (const auto& t : mesh.triangles)
    if (mesh.vertices[t[0]].z == mesh.vertices[t[1]].z && mesh.vertices[t[0]].z == mesh.vertices[t[2]].z)
      sides.triangles.push_back(t);
  const std::vector<WorldPoint> carried = carry_onto(sides, now, context);
  for (size_t v = 0; v < carried.size(); ++v)
    CHECK(std::abs(carried[v].z - (mesh.vertices[v].z < 0.1 ? 0.15 : 0.35)) < 1e-12);
}

TEST_CASE("frames: a mesh whose vertices were shuffled gets its numbers back", "[frames]") {
  const TriangleMesh mesh = mesh_of(shapes::torus(2, 0.7, 40, 20));
  PreviousFrame previous{mesh.vertices, mesh.triangles, mesh.vertices};
  TriangleMesh shuffled = mesh;
  const size_t n = mesh.vertices.size();
  const auto to = [&](uint32_t v) { return uint32_t((v * size_t(331) + 17) % n); };  // 331 and n have no common divisor
  for (uint32_t v = 0; v < n; ++v) shuffled.vertices[to(v)] = mesh.vertices[v];
  for (auto& t : shuffled.triangles) t = {to(t[0]), to(t[1]), to(t[2])};
  shuffled.gap.assign(n, 0);
  shuffled.gap[to(5)] = 1;
  shuffled.features.corners = {to(9)};
  for (size_t t = 0; t < mesh.triangles.size(); ++t)
    shuffled.regions.labels.push_back({int32_t(mesh.triangles[t][0]), 0});
  number_as_before(previous, shuffled);
  CoherenceReport report;
  measure_coherence(previous, shuffled, report);
  CHECK(report.born == 0);
  CHECK(report.kept_edges_pct == 100);
  CHECK(report.excess == 0);
  CHECK(shuffled.gap[5] == 1);
  CHECK(shuffled.features.corners == std::vector<uint32_t>{9});
  CHECK(std::is_sorted(shuffled.triangles.begin(), shuffled.triangles.end()));
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& triangle = shuffled.triangles[t];
    CHECK(std::count(triangle.begin(), triangle.end(), uint32_t(shuffled.regions.labels[t][0])) == 1);
  }
}

TEST_CASE("frames: vertices that are elsewhere, or have no number before, are born", "[frames]") {
  TriangleMesh mesh = mesh_of(shapes::sphere({0, 0, 0}, 1, 24));
  PreviousFrame previous{mesh.vertices, mesh.triangles, mesh.vertices};
  previous.vertices.pop_back();
  previous.carried.pop_back();
  previous.carried[3] = {5, 5, 5};
  const std::vector<uint8_t> born = born_vertices(previous, mesh);
  CHECK(std::count(born.begin(), born.end(), uint8_t(1)) == 2);
  CHECK(born[3] == 1);
  CHECK(born.back() == 1);
}
