// Runs that keep creases: the edges of crisp parts are edges of the result, and all that held without them still holds.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "features/known_curves.h"
#include "isoshell/advanced/digest.h"
#include "isoshell/error.h"
#include "isoshell/mesh_topology.h"
#include "isoshell/quality.h"
#include "isoshell/remesh.h"
#include "support/catch.h"
#include "support/refusals.h"
#include "support/shapes.h"
#include "support/test_context.h"

using namespace isoshell;

namespace {

RemeshOptions keeping_creases(int64_t vertices) {
  RemeshOptions options;
  options.vertices = vertices;
  options.features.creases = Features::Creases::automatic;
  return options;
}

double distance(const WorldPoint& a, const WorldPoint& b) {
  return std::sqrt((a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y) + (a.z - b.z) * (a.z - b.z));
}

/// Turned by odd angles, exactly the same shape to rounding.
TriangleSoup turned(TriangleSoup soup) {
  const double a = 0.3, b = 0.7, c = 1.1;
  for (WorldPoint& p : soup.vertices) {
    const WorldPoint q{p.x * std::cos(a) - p.y * std::sin(a), p.x * std::sin(a) + p.y * std::cos(a), p.z};
    const WorldPoint r{q.x, q.y * std::cos(b) - q.z * std::sin(b), q.y * std::sin(b) + q.z * std::cos(b)};
    p = {r.x * std::cos(c) + r.z * std::sin(c), r.y, r.z * std::cos(c) - r.x * std::sin(c)};
  }
  return soup;
}

/// A right prism over a regular polygon.
TriangleSoup cylinder(double radius, double height, uint32_t sides) {
  TriangleSoup soup;
  for (uint32_t i = 0; i < sides; ++i) {
    const double turn = 6.283185307179586 * i / sides;
    for (const double z : {0., height}) soup.vertices.push_back({radius * std::cos(turn), radius * std::sin(turn), z});
  }
  soup.vertices.push_back({0, 0, 0});
  soup.vertices.push_back({0, 0, height});
  for (uint32_t i = 0; i < sides; ++i) {
    const uint32_t a = 2 * i, b = 2 * ((i + 1) % sides);
    soup.triangles.push_back({a, b, b + 1});
    soup.triangles.push_back({a, b + 1, a + 1});
    soup.triangles.push_back({2 * sides, b, a});
    soup.triangles.push_back({2 * sides + 1, a + 1, b + 1});
  }
  return soup;
}

/// Length of the result's edges that lie on a segment of the input: both ends no farther than this from it.
double length_on(const TriangleMesh& mesh, const WorldPoint& a, const WorldPoint& b, double tolerance) {
  const double length = distance(a, b);
  const WorldPoint along{(b.x - a.x) / length, (b.y - a.y) / length, (b.z - a.z) / length};
  const auto lies_on = [&](uint32_t v) {
    const WorldPoint& p = mesh.vertices[v];
    const double t = (p.x - a.x) * along.x + (p.y - a.y) * along.y + (p.z - a.z) * along.z;
    const WorldPoint foot{a.x + t * along.x, a.y + t * along.y, a.z + t * along.z};
    return distance(p, foot) <= tolerance && t >= -tolerance && t <= length + tolerance;
  };
  double on = 0;
  for (const auto& t : mesh.triangles)
    for (int i = 0; i < 3; ++i) {
      const uint32_t u = t[size_t(i)], v = t[size_t((i + 1) % 3)];
      if (u < v && lies_on(u) && lies_on(v)) on += distance(mesh.vertices[u], mesh.vertices[v]);
    }
  return on;
}

void check_valid(const RemeshResult& result, int64_t vertices, int64_t genus) {
  const MeshTopology topology = check_mesh(result.mesh);
  CHECK(topology.is_closed_manifold());
  CHECK(topology.components == 1);
  CHECK(topology.genus == genus);
  CHECK(result.report.optimize.self_intersections == 0);
  CHECK(int64_t(result.mesh.vertices.size()) == vertices);
}

}  // namespace

TEST_CASE("features: the edges of a box are edges of the result, and its corners vertices", "[features]") {
  TestContext context;
  for (const bool is_turned : {false, true}) {
    TriangleSoup soup = shapes::box({-1, -2, 0}, {1, 2, 1});
    if (is_turned) soup = turned(soup);
    const RemeshResult result = remesh(soup, keeping_creases(800), context);
    check_valid(result, 800, 0);
    CHECK(result.report.features.kept);
    CHECK(result.report.features.curves == 12);
    CHECK(result.report.features.corners == 8);
    CHECK(result.report.features.patches == 6);
    const double fine = result.report.grid.frame.voxel_size / 128;
    for (int edge = 0; edge < 12; ++edge) {
      const int axis = edge / 4, u = edge & 1, v = edge >> 1 & 1;
      const int a = u << (axis + 1) % 3 | v << (axis + 2) % 3, b = a | 1 << axis;
      const WorldPoint &from = soup.vertices[size_t(a)], &to = soup.vertices[size_t(b)];
      INFO("edge " << edge);
      CHECK(std::abs(length_on(result.mesh, from, to, fine) - distance(from, to)) < 4 * fine);
    }
    CHECK(measure_quality(result.mesh).theta_min_deg > 30);
  }
}

TEST_CASE("features: a cylinder keeps its rims and has none along its side", "[features]") {
  TestContext context;
  const RemeshResult result = remesh(cylinder(1, 2, 96), keeping_creases(1000), context);
  check_valid(result, 1000, 0);
  CHECK(result.report.features.kept);
  CHECK(result.report.features.curves == 2);
  CHECK(result.report.features.corners == 0);
  CHECK(measure_quality(result.mesh).theta_min_deg > 30);
}

TEST_CASE("features: a smooth shape is remeshed as if none were looked for", "[features]") {
  TestContext context;
  const TriangleSoup soup = shapes::torus(2, 0.7, 96, 48);
  RemeshOptions without = keeping_creases(600);
  without.features.creases = Features::Creases::off;
  const RemeshResult result = remesh(soup, keeping_creases(600), context);
  CHECK_FALSE(result.report.features.kept);
  CHECK(result.report.features.curves == 0);
  CHECK(result.report.warnings.empty());
  CHECK(digest(result.mesh) == digest(remesh(soup, without, context).mesh));
}

TEST_CASE("features: an angle decides which edges are creases", "[features]") {
  TestContext context;
  RemeshOptions options = keeping_creases(600);
  options.features = {Features::Creases::threshold, 50};
  CHECK(remesh(cylinder(1, 2, 6), options, context).report.features.curves == 18);
  options.features.degrees = 70;
  CHECK(remesh(cylinder(1, 2, 6), options, context).report.features.curves == 12);  // rims with six corners each
}

TEST_CASE("features: an open surface loses its creases, and the run says so", "[features]") {
  TestContext context;
  TriangleSoup soup = shapes::box({0, 0, 0}, {2, 2, 2});
  soup.triangles.resize(10);  // no lid
  const RemeshResult result = remesh(soup, keeping_creases(400), context);
  CHECK(check_mesh(result.mesh).is_closed_manifold());
  if (!result.report.features.kept) CHECK_FALSE(result.report.features.given_up.empty());
}

TEST_CASE("features: a cube without one of its triangles keeps its twelve creases", "[features]") {
  TestContext context;
  TriangleSoup soup = shapes::box({0, 0, 0}, {2, 2, 2});
  soup.triangles.pop_back();
  const RemeshResult result = remesh(soup, keeping_creases(400), context);
  check_valid(result, 400, 0);
  CHECK(result.report.features.kept);
  CHECK(result.report.features.curves == 12);
  CHECK(result.report.features.on_sheet.empty());
}

TEST_CASE("features: a box that a fin stands on keeps its other edges, on the sheet", "[features]") {
  TestContext one, more;
  one.threads = 1;
  more.threads = 3;
  TriangleSoup soup = shapes::box({0, 0, 0}, {2, 2, 2});
  soup.vertices.push_back({1, 1, 3.5});
  soup.triangles.push_back({4, 5, 8});  // on an upper edge
  const RemeshResult result = remesh(soup, keeping_creases(800), one);
  CHECK(check_mesh(result.mesh).is_closed_manifold());
  CHECK(result.report.optimize.self_intersections == 0);
  CHECK(result.report.features.kept);
  CHECK_FALSE(result.report.features.on_sheet.empty());
  CHECK(result.report.features.curves == 11);  // one edge has three faces
  const double fine = result.report.grid.frame.voxel_size / 128;
  double kept = 0;
  for (const uint32_t a : {0u, 1u, 2u, 3u, 4u, 5u, 6u, 7u})
    for (const uint32_t axis : {1u, 2u, 4u})
      if ((a & axis) == 0) kept += length_on(result.mesh, soup.vertices[a], soup.vertices[a | axis], fine);
  CHECK(kept > .95 * 22);
  CHECK(result.report.features.kept_length_world > .95 * 22);
  CHECK(result.report.features.kept_length_world <= result.report.features.length_world);
  for (const LostCurve& curve : result.report.features.lost) CHECK(curve.index < 12);
  CHECK(measure_quality(result.mesh).theta_min_deg > 20);
  CHECK(digest(result.mesh) == digest(remesh(soup, keeping_creases(800), more).mesh));
}

TEST_CASE("features: more places on curves than vertices are no error", "[features]") {
  TestContext context;
  const RemeshResult result = remesh(cylinder(1, 2, 6), keeping_creases(20), context);
  CHECK(check_mesh(result.mesh).is_closed_manifold());
  CHECK(result.mesh.vertices.size() == 20);
}

namespace {

/// With 25 cells of a unit on its first 11 x 11: 12 of length on each.
TriangleSoup plate_with_cells(int width) {
  std::set<std::array<int, 3>> plate;
  for (int x = 0; x < width; ++x)
    for (int y = 0; y < width; ++y) {
      plate.insert({x, y, 0});
      if (x < 11 && y < 11 && x % 2 == 1 && y % 2 == 1) plate.insert({x, y, 1});
    }
  return known_curves::cells(plate, 2);
}

}  // namespace

TEST_CASE("features: where curves have more vertices than lengths ask for, faces far from them have their share",
          "[features]") {
  TestContext context;
  const RemeshResult result = remesh(plate_with_cells(21), keeping_creases(360), context);
  check_valid(result, 360, 0);
  const FeatureReport& features = result.report.features;
  CHECK(features.kept_length_world == Approx(features.length_world));
  CHECK(features.vertices > 250);  // of these 208 are corners
  int below = 0;
  for (const WorldPoint& p : result.mesh.vertices)
    if (p.z < 1e-3 && p.x > .1 && p.y > .1 && p.x < 20.9 && p.y < 20.9) ++below;
  CHECK(below > 45);  // 32 where lengths are as if there were no curves
}

TEST_CASE("features: edges are longer before creases are left out", "[features]") {
  TestContext context;
  const RemeshResult result = remesh(plate_with_cells(11), keeping_creases(260), context);
  check_valid(result, 260, 0);
  CHECK(result.report.features.kept_length_world == Approx(result.report.features.length_world));
}

TEST_CASE("features: where vertices are too few for all creases the longest are kept, and the others named",
          "[features]") {
  TestContext context;
  const RemeshResult result = remesh(plate_with_cells(11), keeping_creases(200), context);
  const FeatureReport& features = result.report.features;
  CHECK(check_mesh(result.mesh).is_closed_manifold());
  CHECK(result.mesh.vertices.size() == 200);
  CHECK(features.kept);
  CHECK(features.vertices <= 154);
  CHECK(features.kept_length_world > 60);
  CHECK(features.kept_length_world < .9 * features.length_world);
  CHECK_FALSE(features.lost.empty());
  for (const LostCurve& curve : features.lost) CHECK_FALSE(curve.reason.empty());
  CHECK(length_on(result.mesh, {0, 0, 0}, {11, 0, 0}, 1e-3) > 10);
}

TEST_CASE("features: a part that touches itself in a plane keeps its creases, and becomes a ring", "[features]") {
  // Both arms of a U bend inward until they touch, and one is higher than the other.
  TriangleSoup soup =
      known_curves::cells({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}, {2, 1, 0}, {0, 2, 0}, {2, 2, 0}}, 2);
  for (WorldPoint& p : soup.vertices) {
    const double bent = std::min(1., std::max(0., p.y - 1));
    const bool is_left = p.x < 1.5;
    p = {p.x + (is_left ? .5 : -.5) * bent, p.y + (is_left ? 0 : .3) * bent, p.z + (is_left ? 0 : .2) * bent};
  }
  TestContext context;
  const RemeshResult result = remesh(soup, keeping_creases(1500), context);
  const FeatureReport& features = result.report.features;
  const MeshTopology topology = check_mesh(result.mesh);
  CHECK(topology.is_closed_manifold());
  CHECK(topology.genus == 1);
  CHECK(std::any_of(result.report.warnings.begin(), result.report.warnings.end(), [](const std::string& text) {
    return text.find("the part touches or crosses itself") != std::string::npos;
  }));
  CHECK(features.kept);
  CHECK(features.on_sheet.empty());
  CHECK(features.kept_length_world == Approx(features.length_world));
  CHECK(length_on(result.mesh, {1.5, 2.3, .2}, {1.5, 3, .2}, 1e-3) > .6);  // where one arm ends on the other
  CHECK(result.report.optimize.self_intersections == 0);
}

TEST_CASE("features: bars whose faces nearly lie in one plane keep creases on their own triangles", "[features]") {
  TriangleSoup star;
  const int bars = 28;
  for (int i = 0; i < bars; ++i) {
    const double turn = std::acos(-1.) * i / bars, tilt = .007 * i;
    TriangleSoup bar = shapes::box({-1, -.1, -.1}, {1, .1, .1});
    for (WorldPoint& p : bar.vertices) {
      const double y = p.y * std::cos(tilt) - p.z * std::sin(tilt);
      p = {p.x * std::cos(turn) - y * std::sin(turn), p.x * std::sin(turn) + y * std::cos(turn),
           p.y * std::sin(tilt) + p.z * std::cos(tilt)};
    }
    star = i == 0 ? bar : shapes::together(std::move(star), bar);
  }
  TestContext context;
  const RemeshResult result = remesh(star, keeping_creases(1000), context);
  CHECK(result.report.features.on_sheet.empty());
  CHECK(result.report.features.kept);
  CHECK(result.report.optimize.self_intersections == 0);
  CHECK(check_mesh(result.mesh).is_closed_manifold());
}

TEST_CASE("features: few vertices on a fine grid are no error", "[features]") {
  TestContext context;
  RemeshOptions options = keeping_creases(60);
  options.resolution = 700;  // triangles of coarse levels are longer than what their stages take
  const RemeshResult result = remesh(shapes::box({0, 0, 0}, {1, 1, 1}), options, context);
  CHECK(check_mesh(result.mesh).is_closed_manifold());
  CHECK(result.report.features.kept);
}

TEST_CASE("features: the bytes are the same for any number of threads", "[features]") {
  TestContext one, more;
  one.threads = 1;
  more.threads = 3;
  const TriangleSoup soup = turned(shapes::box({0, 0, 0}, {3, 2, 1}));
  CHECK(digest(remesh(soup, keeping_creases(700), one).mesh) == digest(remesh(soup, keeping_creases(700), more).mesh));
}

TEST_CASE("features: the paper's loop on the shell keeps none, and refuses an angle", "[features]") {
  TestContext context;
  RemeshOptions options = keeping_creases(100);
  options.method = Method::shell;
  CHECK_FALSE(remesh(shapes::box({0, 0, 0}, {1, 1, 1}), options, context).report.features.kept);
  options.features = {Features::Creases::threshold, 30};
  CHECK_THROWS_AS(remesh(shapes::box({0, 0, 0}, {1, 1, 1}), options, context), Error);
}

TEST_CASE("features: what cannot be cut is remeshed without, closed, and the run says so", "[features]") {
  TestContext context;
  const TriangleSoup cube = shapes::box({0, 0, 0}, {2, 2, 2});
  TriangleSoup capped = cube;
  capped.triangles.pop_back();
  const std::vector<std::pair<std::string, TriangleSoup>> inputs = {
      {"inside out", shapes::inside_out(cube)},
      {"touching in a corner", shapes::together(cube, shapes::box({2, 2, 2}, {4, 4, 4}))},
      {"with a tiny part", shapes::together(cube, shapes::box({3, 3, 3}, {3.01, 3.01, 3.01}))},
      {"a thin plate", shapes::box({0, 0, 0}, {1, 1, 0.01})},
      {"with a hole", capped},
  };
  for (const auto& [name, soup] : inputs) {
    INFO(name);
    const RemeshResult result = remesh(soup, keeping_creases(500), context);
    CHECK(check_mesh(result.mesh).is_closed_manifold());
    CHECK((result.report.features.kept || !result.report.features.given_up.empty()));
    double volume = 0;
    for (const auto& t : result.mesh.triangles) {
      const WorldPoint &a = result.mesh.vertices[t[0]], &b = result.mesh.vertices[t[1]],
                       &c = result.mesh.vertices[t[2]];
      volume += a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x);
    }
    CHECK(volume > 0);
  }
}

TEST_CASE("features: a needle that no crease has room on is meshed without them, each time the same", "[features]") {
  RemeshOptions options = keeping_creases(150);
  options.closing_vox = 4;
  std::set<uint64_t> digests;
  for (const int threads : {1, 2}) {
    TestContext context;
    context.threads = threads;
    const RemeshResult result = remesh(shapes::box({0, 0, 0}, {1, 0.0005, 0.0005}), options, context);
    const FeatureReport& features = result.report.features;
    CHECK(check_mesh(result.mesh).is_closed_manifold());
    CHECK_FALSE(features.kept);
    CHECK(contains(features.given_up, "edges are too long"));
    CHECK(features.lost.size() == 12);
    digests.insert(digest(result.mesh));
  }
  CHECK(digests.size() == 1);
}

TEST_CASE("features: of many lost curves the longest are listed, and reasons with all of their lengths", "[features]") {
  const std::vector<LostCurve> lost = {{0, "crease", 1, {}, "short"},
                                       {1, "crease", 3, {}, "long"},
                                       {2, "seam", 1, {}, "short"},
                                       {3, "line", 2, {}, "far"}};
  CHECK(lost_length_world(lost) == 7);
  const std::vector<LostCurve> longest = longest_of(lost, 3);
  REQUIRE(longest.size() == 3);
  CHECK(longest[0].index == 1);
  CHECK(longest[1].index == 3);
  CHECK(longest[2].index == 0);
  CHECK(longest_of(lost, 9).size() == 4);
  const std::vector<LostForReason> reasons = lost_by_reason(lost, 2);
  REQUIRE(reasons.size() == 2);
  CHECK(reasons[0].reason == "long");
  CHECK(reasons[1].reason == "far");
  CHECK(lost_by_reason(lost, 9).back().curves == 2);
}
