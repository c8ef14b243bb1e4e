// Runs that keep borders: an open surface stays open, its rims are rims of the result, and what cannot be kept is said.
#include <cmath>
#include <functional>

#include "isoshell/advanced/digest.h"
#include "isoshell/borders.h"
#include "isoshell/error.h"
#include "isoshell/io/vdb_file.h"
#include "isoshell/mesh_topology.h"
#include "isoshell/quality.h"
#include "isoshell/run/run.h"
#include "support/catch.h"
#include "support/mesh_files.h"
#include "support/shapes.h"
#include "support/temporary_file.h"
#include "support/test_context.h"

using namespace isoshell;

namespace {

RemeshOptions keeping_borders(int64_t vertices) {
  RemeshOptions options;
  options.vertices = vertices;
  options.boundary = Boundary::keep;
  options.closing_vox = 0;
  return options;
}

/// Without the faces whose middles are in the way.
TriangleSoup without(TriangleSoup soup, const std::function<bool(WorldPoint)>& is_gone) {
  const auto gone = [&](const std::array<uint32_t, 3>& t) {
    const WorldPoint &p = soup.vertices[t[0]], &q = soup.vertices[t[1]], &r = soup.vertices[t[2]];
    return is_gone({(p.x + q.x + r.x) / 3, (p.y + q.y + r.y) / 3, (p.z + q.z + r.z) / 3});
  };
  soup.triangles.erase(std::remove_if(soup.triangles.begin(), soup.triangles.end(), gone), soup.triangles.end());
  return soup;
}

TriangleSoup half_ball() {
  return without(shapes::sphere({0, 0, 0}, 1, 64), [](WorldPoint p) { return p.z < 0; });
}

/// A ball without its bottom and without a small piece of its top.
TriangleSoup ball_with_two_holes() {
  return without(shapes::sphere({0, 0, 0}, 1, 64), [](WorldPoint p) { return p.z < -.29 || p.z > .92; });
}

/// n x n squares in the plane, lifted by `height`, without those where `is_hole`.
TriangleSoup sheet(
    uint32_t n, const std::function<double(double, double)>& height,
    const std::function<bool(uint32_t, uint32_t)>& is_hole = [](uint32_t, uint32_t) { return false; }) {
  TriangleSoup soup;
  for (uint32_t i = 0; i <= n; ++i)
    for (uint32_t j = 0; j <= n; ++j) {
      const double x = double(i) / n, y = double(j) / n;
      soup.vertices.push_back({x, y, height(x, y)});
    }
  const auto at = [&](uint32_t i, uint32_t j) { return i * (n + 1) + j; };
  for (uint32_t i = 0; i < n; ++i)
    for (uint32_t j = 0; j < n; ++j) {
      if (is_hole(i, j)) continue;
      soup.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      soup.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return soup;
}
double flat(double, double) { return 0; }
double wavy(double x, double y) { return .1 * std::sin(6 * x) * std::cos(5 * y); }

TriangleSoup moved(TriangleSoup soup, WorldPoint by) {
  for (WorldPoint& p : soup.vertices) p = {p.x + by.x, p.y + by.y, p.z + by.z};
  return soup;
}

/// A manifold with the borders of the input, on its rims, and with every vertex that was asked for.
void check_kept(const RemeshResult& result, const TriangleSoup& input, int64_t vertices, int64_t loops,
                int64_t components) {
  const MeshTopology topology = check_mesh(result.mesh);
  CHECK(result.report.features.kept);
  CHECK(result.report.features.given_up.empty());
  CHECK(topology.is_manifold_with(loops));
  CHECK(result.report.features.border_loops == loops);
  CHECK(topology.components == components);
  CHECK(int64_t(result.mesh.vertices.size()) == vertices);
  CHECK(result.report.optimize.self_intersections == 0);
  Context context;
  const BorderMeasures borders = measure_borders(result.mesh, mesh_of(input), context);
  CHECK(borders.to_reference_max < result.report.grid.frame.voxel_size / 128);
  CHECK(std::abs(borders.length_world / borders.reference_length_world - 1) < .01);
}

}  // namespace

TEST_CASE("borders: the rim of half a ball is the rim of the result", "[borders]") {
  TestContext context;
  const TriangleSoup input = half_ball();
  const RemeshResult result = remesh(input, keeping_borders(1000), context);
  check_kept(result, input, 1000, 1, 1);
  CHECK(result.report.warnings.empty());
  CHECK(measure_quality(result.mesh).theta_min_deg > 30);
}

TEST_CASE("borders: a wavy sheet keeps its four sides and its corners", "[borders]") {
  TestContext context;
  const TriangleSoup input = sheet(40, wavy);
  const RemeshResult result = remesh(input, keeping_borders(800), context);
  check_kept(result, input, 800, 1, 1);
  for (const double x : {0., 1.})
    for (const double y : {0., 1.}) {
      double nearest = 1;
      for (const WorldPoint& p : result.mesh.vertices)
        nearest = std::min(nearest, std::hypot(p.x - x, p.y - y, p.z - wavy(x, y)));
      CHECK(nearest < result.report.grid.frame.voxel_size / 128);
    }
}

TEST_CASE("borders: parts that are open and parts that are closed stay what they are", "[borders]") {
  TestContext context;
  const TriangleSoup input = shapes::together(shapes::together(half_ball(), moved(sheet(20, wavy), {2, 0, 0})),
                                              shapes::sphere({0, 3, 0}, .7, 48));
  check_kept(remesh(input, keeping_borders(1500), context), input, 1500, 2, 3);
}

TEST_CASE("borders: a small open part is no island where every loop is kept", "[borders]") {
  TestContext context;
  TriangleSoup small = sheet(4, flat);
  for (WorldPoint& p : small.vertices) p = {.1 * p.x + 2, .1 * p.y, .1 * p.z};
  const TriangleSoup input = shapes::together(half_ball(), small);
  check_kept(remesh(input, keeping_borders(3000), context), input, 3000, 2, 2);
}

TEST_CASE("borders: holes that are narrower than the gaps to close are closed, wider ones stay", "[borders]") {
  TestContext context;
  const TriangleSoup input = ball_with_two_holes();
  check_kept(remesh(input, keeping_borders(1000), context), input, 1000, 2, 1);
  RemeshOptions options = keeping_borders(1000);
  options.closing_vox.reset();
  options.closing_world = .9;  // the smaller one is .77 wide
  const RemeshResult result = remesh(input, options, context);
  CHECK(result.report.features.kept);
  CHECK(result.report.input.repair.capped_loops == 1);
  CHECK(check_mesh(result.mesh).is_manifold_with(1));
  CHECK(result.report.gaps.vertices > 0);
  CHECK(result.mesh.gap.size() == result.mesh.vertices.size());
  options.closing_world.reset();  // the run chooses what is a hole: neither rim is as wide as the ball
  const RemeshResult chosen = remesh(half_ball(), options, context);
  CHECK(check_mesh(chosen.mesh).is_manifold_with(1));
}

TEST_CASE("borders: a loop that passes a vertex twice parts there, and the count stays exact", "[borders]") {
  TestContext context;
  const TriangleSoup input =
      sheet(24, wavy, [](uint32_t i, uint32_t j) { return (i / 4 == 1 && j / 4 == 1) || (i / 4 == 2 && j / 4 == 2); });
  const RemeshResult holes = remesh(input, keeping_borders(900), context);
  CHECK(holes.report.features.kept);
  CHECK(int64_t(holes.mesh.vertices.size()) == 900);
  CHECK(check_mesh(holes.mesh).is_manifold_with(holes.report.features.border_loops));
  const TriangleSoup touching = sheet(24, wavy, [](uint32_t i, uint32_t j) { return (i < 12) != (j < 12); });
  const RemeshResult parts = remesh(touching, keeping_borders(900), context);
  check_kept(parts, touching, 900, 2, 2);
}

TEST_CASE("borders: with creases both are kept", "[borders]") {
  TestContext context;
  TriangleSoup input = shapes::box({0, 0, 0}, {2, 2, 1});
  input.triangles.resize(10);  // an open box
  RemeshOptions options = keeping_borders(900);
  options.features.creases = Features::Creases::automatic;
  const RemeshResult result = remesh(input, options, context);
  check_kept(result, input, 900, 1, 1);
  CHECK(result.report.features.curves > 0);
  CHECK(result.report.features.patches == 5);
}

TEST_CASE("borders: faces that disagree are turned, and edges of three faces close the result with a warning",
          "[borders]") {
  TestContext context;
  TriangleSoup mixed = sheet(20, wavy);
  for (size_t t = 0; t < mixed.triangles.size(); t += 3) std::swap(mixed.triangles[t][0], mixed.triangles[t][1]);
  check_kept(remesh(mixed, keeping_borders(600), context), mixed, 600, 1, 1);

  TriangleSoup book = sheet(20, flat);
  for (const auto& lift : {1., -1.})
    book = shapes::together(book, without(sheet(20, [=](double x, double) { return lift * (x - .5); }),
                                          [](WorldPoint p) { return p.x < .5; }));
  const RemeshResult closed = remesh(book, keeping_borders(800), context);
  CHECK_FALSE(closed.report.features.kept);
  CHECK(closed.report.features.border_loops == 0);
  CHECK(closed.report.features.given_up.find("more than two faces") != std::string::npos);
  CHECK(check_mesh(closed.mesh).is_closed_manifold());
  bool is_said = false;
  for (const std::string& text : closed.report.warnings) is_said |= text.find("not kept") != std::string::npos;
  CHECK(is_said);
}

TEST_CASE("borders: sheets that pass through each other stay, and the intersections are said to be the input's",
          "[borders]") {
  TestContext context;
  TriangleSoup upright = sheet(20, flat);
  for (WorldPoint& p : upright.vertices) p = {p.x * .8 + .1003, .50021, p.y - .4987};
  const TriangleSoup input = shapes::together(sheet(20, flat), upright);
  const RemeshResult result = remesh(input, keeping_borders(800), context);
  CHECK(result.report.features.kept);
  CHECK(check_mesh(result.mesh).is_manifold_with(2));
  CHECK(result.report.optimize.self_intersections > 0);
  bool is_said = false;
  for (const std::string& text : result.report.warnings)
    is_said |= text.find("where the input's own triangles do") != std::string::npos;
  CHECK(is_said);
}

TEST_CASE("borders: a closed surface is remeshed as if none were kept", "[borders]") {
  TestContext context;
  const TriangleSoup ball = shapes::sphere({0, 0, 0}, 1, 48);
  RemeshOptions keep = keeping_borders(400), close = keep;
  close.boundary = Boundary::close;
  CHECK(digest(remesh(ball, keep, context).mesh) == digest(remesh(ball, close, context).mesh));
}

TEST_CASE("borders: an edge length counts one side of an open surface", "[borders]") {
  TestContext context;
  RemeshOptions options = keeping_borders(0);
  options.edge_length_world = .05;
  const RemeshResult result = remesh(sheet(20, flat), options, context);
  CHECK(result.report.features.kept);
  CHECK(std::abs(double(result.mesh.vertices.size()) - 1 / (.866 * .05 * .05)) < 30);
}

TEST_CASE("borders: the bytes are the same for any number of threads and order of faces", "[borders]") {
  TestContext one, more;
  one.threads = 1;
  more.threads = 3;
  const TriangleSoup input = ball_with_two_holes();
  const uint64_t expected = digest(remesh(input, keeping_borders(700), one).mesh);
  CHECK(digest(remesh(input, keeping_borders(700), more).mesh) == expected);
  CHECK(digest(remesh(shapes::shuffled(input, 3), keeping_borders(700), more).mesh) == expected);
}

TEST_CASE("borders: the paper's loop on the shell refuses to keep them", "[borders]") {
  TestContext context;
  RemeshOptions options = keeping_borders(100);
  options.method = Method::shell;
  CHECK_THROWS_AS(remesh(half_ball(), options, context), Error);
}

TEST_CASE("borders: a run that resumes from a shell ends with the same bytes", "[borders][vdb]") {
  if (!can_write_vdb()) return;
  const TemporaryFile shell("borders.vdb");
  TestContext context;
  RunRequest first;
  first.options = requested_options(keeping_borders(600));
  first.save_shell = shell.path;
  first.overwrite = true;
  Input input;
  input.soup = ball_with_two_holes();
  input.facts.kind = InputKind::mesh;
  const RunResult made = run(std::move(input), first, context);
  CHECK(made.record.report.features.kept);
  RunRequest second;
  second.input = named_input(shell.path);
  const RunResult resumed = run(second, context);
  CHECK(resumed.record.report.features.border_loops == 2);
  CHECK(digest(resumed.mesh) == digest(made.mesh));
  second.options.values.boundary = Boundary::close;
  second.options.given = {"boundary"};
  CHECK_THROWS_AS(run(second, context), Error);
}

TEST_CASE("borders: a run measures those it kept", "[borders]") {
  TestContext context;
  RunRequest request;
  request.options = requested_options(keeping_borders(600));
  request.measures = Measures::all;
  request.gates = parse_gates("manifold,boundary-loops=2,no-self-intersections,closed");
  Input input;
  input.soup = ball_with_two_holes();
  input.facts.kind = InputKind::mesh;
  const RunResult result = run(std::move(input), request, context);
  REQUIRE(result.record.borders);
  CHECK(result.record.borders->loops == 2);
  CHECK(result.record.borders->reference_loops == 2);
  CHECK(result.record.borders->to_reference_max < result.record.report.grid.frame.voxel_size / 128);
  CHECK(result.missed_gates == std::vector<std::string>{"closed: the mesh has 2 open boundaries"});
  CHECK(result.record.warnings.empty());
}
