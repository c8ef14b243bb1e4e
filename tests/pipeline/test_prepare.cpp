// prepare on surfaces that are open, or several that pass through each other.
#include <algorithm>
#include <cmath>

#include "isoshell/isoshell.h"
#include "support/catch.h"
#include "support/prepared_run.h"
#include "support/refusals.h"
#include "support/shapes.h"
#include "support/solid_soup.h"
#include "support/test_context.h"
#include "voxel/leaf.h"

using namespace isoshell;

namespace {

/// Volume inside the sheet in terms of a ball whose diameter is the grid's longest side.
double volume_in_balls(const PreparedRun& run) {
  TestContext context;
  const double radius_vox = .5 * run.report.grid.frame.resolution;
  return double(six_volume_vox(run.prepared.sheet(), context)) / (8 * 3.14159 * radius_vox * radius_vox * radius_vox);
}

/// A unit ball's surface with a slot of this width along a quarter of its equator.
TriangleSoup slotted_ball(double width) {
  constexpr uint32_t kAround = 96, kRows = 24;
  TriangleSoup soup;
  std::vector<double> height;
  for (uint32_t j = 0; j < kRows; ++j)
    if (const double z = std::cos(1.5707963 * j / kRows); z > width / 2) height.push_back(-z);
  height.push_back(-width / 2);
  const size_t below = height.size();
  for (size_t j = below; j-- > 0;) height.push_back(-height[j]);
  const double tau = 6.283185307179586;
  for (const double z : height)
    for (uint32_t i = 0; i < kAround; ++i) {
      const double r = std::sqrt(1 - z * z);
      soup.vertices.push_back({r * std::cos(tau * i / kAround), r * std::sin(tau * i / kAround), z});
    }
  for (uint32_t j = 0; j + 1 < height.size(); ++j)
    for (uint32_t i = 0; i < kAround; ++i) {
      if (j + 1 == below && i < kAround / 4) continue;
      const uint32_t a = j * kAround + i, b = j * kAround + (i + 1) % kAround;
      shapes::add_triangle(soup, a, b, b + kAround);
      shapes::add_triangle(soup, a, b + kAround, a + kAround);
    }
  return soup;
}

}  // namespace

TEST_CASE("prepare: balls through each other are one body, on the first grid; balls apart stay two", "[prepare]") {
  RemeshOptions options;
  options.vertices = 500;
  const TriangleSoup ball = shapes::sphere({0, 0, 0}, 1, 32);
  const PreparedRun joined = prepare_with(shapes::together(ball, shapes::sphere({1, .1, 0}, 1, 32)), options);
  CHECK(joined.report.input.topology.components == 2);
  CHECK(joined.report.sheet.topology.components == 1);
  CHECK(joined.report.sheet.topology.genus == 0);
  CHECK(joined.report.sheet.agrees);  // with the union, which is one mesh
  CHECK(joined.report.warnings.empty());
  TriangleSoup two = shapes::together(ball, shapes::sphere({2.3, .1, 0}, 1, 32));
  const PreparedRun apart = prepare_with(two, options);
  CHECK(apart.report.sheet.topology.components == 2);
  CHECK(apart.report.sheet.agrees);
  two = shapes::together(two, shapes::sphere({0, 2, 0}, 1e-7, 8));  // a point on the lattice: joined with nothing
  CHECK(prepare_with(two, options).report.sheet.is_compared);
}

TEST_CASE("prepare: a hollow ball stays hollow, unless only outer surfaces are wanted", "[prepare]") {
  RemeshOptions options;
  options.resolution = 150;
  const TriangleSoup hollow =
      shapes::together(shapes::sphere({0, 0, 0}, 1, 48), shapes::inside_out(shapes::sphere({.1, 0, 0}, .6, 48)));
  RemeshOptions outer_only = options;
  outer_only.outer_only = true;
  const PreparedRun outer = prepare_with(hollow, outer_only);
  CHECK(outer.report.sheet.topology.components == 1);
  CHECK(outer.report.sheet.agrees);
  const double ball = volume_in_balls(outer);
  for (const TriangleSoup& soup : {hollow, shapes::inside_out(hollow)}) {
    const PreparedRun kept = prepare_with(soup, options);
    CHECK(kept.report.input.united.inner_surfaces == 1);
    CHECK(kept.report.sheet.topology.components == 2);
    CHECK(kept.report.sheet.agrees);
    CHECK(volume_in_balls(kept) / ball == Approx(1 - .216).margin(.01));
  }
  const PreparedRun nested = prepare_with(shapes::together(hollow, shapes::sphere({.1, 0, 0}, .3, 32)), options);
  CHECK(nested.report.sheet.topology.components == 3);
  CHECK(nested.report.sheet.agrees);
  CHECK(volume_in_balls(nested) / ball == Approx(1 - .216 + .027).margin(.01));
}

TEST_CASE("prepare: hollows about as small as a voxel do not open the solid around them", "[prepare]") {
  RemeshOptions options;
  options.resolution = 40;
  TriangleSoup ball = shapes::sphere({0, 0, 0}, 1, 32);
  for (const double radius_vox : {.4, .7, 1., 1.3, 1.6}) {
    const double at = radius_vox / 4 - .3;
    ball = shapes::together(ball, shapes::inside_out(shapes::sphere({at, .2, .1 - at}, radius_vox * 2 / 39, 12)));
  }
  const PreparedRun run = prepare_with(ball, options);
  CHECK(run.report.input.united.inner_surfaces == 5);
  CHECK(volume_in_balls(run) > .9);
}

TEST_CASE("prepare: smooth bodies within a voxel of one another stay apart, on their own triangles", "[prepare]") {
  TestContext context;
  const auto ball = [](double radius) { return shapes::sphere({0, 0, 0}, radius, 64); };
  const TriangleSoup nested = shapes::together(shapes::together(ball(1), shapes::inside_out(ball(.985))), ball(.97));
  for (const Features::Creases creases : {Features::Creases::automatic, Features::Creases::off}) {
    RemeshOptions options;
    options.vertices = 2000;
    options.features.creases = creases;
    const RemeshResult result = remesh(nested, options, context);
    const MeshTopology topology = check_mesh(result.mesh);
    CHECK(topology.components == 3);
    CHECK(topology.is_manifold_with(0));
    CHECK(result.mesh.vertices.size() == 2000);
    CHECK(result.report.optimize.self_intersections == 0);
    CHECK(result.report.warnings.empty());
  }
}

TEST_CASE("prepare: a hollow survives coarse levels, and a run from the lattice", "[prepare]") {
  RemeshOptions options;
  options.vertices = 1000;
  const TriangleSoup hollow =
      shapes::together(shapes::sphere({0, 0, 0}, 1, 48), shapes::inside_out(shapes::sphere({.1, 0, 0}, .6, 48)));
  TestContext context;
  const RemeshResult result = remesh(hollow, options, context);
  const MeshTopology topology = check_mesh(result.mesh);
  CHECK(topology.is_closed_manifold());
  CHECK(topology.components == 2);
  CHECK(result.mesh.vertices.size() == 1000);
  CHECK(result.report.optimize.self_intersections == 0);
  const PreparedRun first = prepare_with(hollow, options);
  const Prepared resumed = prepare(to_host(first.prepared.surface()), 0, options, context);
  CHECK(digest(resumed.sheet()) == digest(first.prepared.sheet()));
}

TEST_CASE("prepare: bars through each other that make a frame have its handle", "[prepare]") {
  RemeshOptions options;
  options.vertices = 800;
  TriangleSoup frame = shapes::box({-.4, 0, 0}, {4.4, 1, 1});
  frame = shapes::together(frame, shapes::box({-.5, 3, .1}, {4.3, 4, .9}));
  frame = shapes::together(frame, shapes::box({.1, -.3, .2}, {1.1, 4.2, .8}));
  frame = shapes::together(frame, shapes::box({3, -.2, -.1}, {4, 4.3, 1.1}));
  const PreparedRun run = prepare_with(frame, options);
  CHECK(run.report.input.united.cut_faces > 0);
  CHECK(run.report.sheet.topology.components == 1);
  CHECK(run.report.sheet.topology.genus == 1);
}

TEST_CASE("prepare: vertices over a hole are flagged, whether faces closed it or voxels", "[prepare]") {
  TriangleSoup holed = shapes::sphere({0, 0, 0}, 1, 64);
  const double hole_height = .9;
  holed.triangles.erase(
      std::remove_if(holed.triangles.begin(), holed.triangles.end(),
                     [&](const std::array<uint32_t, 3>& t) { return holed.vertices[t[0]].z > hole_height; }),
      holed.triangles.end());
  RemeshOptions options;
  options.vertices = 600;
  TestContext context;
  const RemeshResult capped = remesh(holed, options, context);
  REQUIRE(capped.mesh.gap.size() == 600);
  int64_t flagged = 0;
  for (size_t i = 0; i < 600; ++i) {
    const WorldPoint& p = capped.mesh.vertices[i];
    flagged += capped.mesh.gap[i];
    if (capped.mesh.gap[i]) CHECK(p.z > hole_height - .1);
    if (std::hypot(p.x, p.y) < .3 && p.z > 0) CHECK(capped.mesh.gap[i] == 1);
  }
  CHECK(flagged > 5);
  CHECK(capped.report.gaps.vertices == flagged);
  CHECK(capped.report.gaps.area_world == Approx(capped.report.input.repair.cap_area_world).epsilon(.2));
  CHECK(remesh(shapes::sphere({0, 0, 0}, 1, 32), options, context).mesh.gap.empty());

  options.resolution = 100;
  options.closing_world = 12 * 2. / 99;
  const RemeshResult bridged = remesh(slotted_ball(8 * 2. / 99), options, context);
  CHECK(bridged.report.input.repair.capped_loops == 0);
  CHECK(bridged.report.gaps.vertices > 0);
  CHECK(bridged.report.gaps.bridges == 1);
  for (size_t i = 0; i < bridged.mesh.gap.size(); ++i)
    if (bridged.mesh.gap[i]) CHECK(std::abs(bridged.mesh.vertices[i].z) < .15);
}

TEST_CASE("prepare: sites that hold both sides of a thin plate are risky, those of a cube are not", "[prepare]") {
  RemeshOptions options;
  options.vertices = 200;
  options.resolution = 40;
  const PreparedRun plate = prepare_with(shapes::box({0, 0, 0}, {1, 1, .003}), options);
  const std::vector<uint8_t> risks = find_risks(plate.prepared.surface(), plate.prepared.samples());
  CHECK(std::count(risks.begin(), risks.end(), 1) > int64_t(risks.size()) / 3);
  const PreparedRun cube = prepare_with(shapes::box({0, 0, 0}, {1, 1, 1}), options);
  const std::vector<uint8_t> none = find_risks(cube.prepared.surface(), cube.prepared.samples());
  CHECK(std::count(none.begin(), none.end(), 1) == 0);
}

TEST_CASE("prepare: a limit that the faces alone exceed ends it before they are mended", "[prepare]") {
  TriangleSoup open = shapes::sphere({0, 0, 0}, 1, 60);
  open.triangles.pop_back();
  RemeshOptions options;
  options.vertices = 100;
  TestContext context;
  context.memory_limit_bytes = 1 << 20;
  try {
    prepare(open, options, context);
    FAIL_CHECK("was prepared");
  } catch (const Error& error) {  // says so of a limit that no grid would meet
    CHECK(std::string(error.what()).find("which its faces take; raise --max-memory") != std::string::npos);
  }
}

TEST_CASE("prepare: where closing fills open surfaces to less than half an edge, walls are grown", "[prepare]") {
  RemeshOptions options;
  options.vertices = 2000;
  const PreparedRun run = prepare_with(shapes::random_soup(60, 2, .7, 11), options);
  CHECK(run.report.grid.grown_vox > 0);
  options.vertices = 100;  // edges as long as the faces: solid
  CHECK(volume_in_balls(prepare_with(slotted_ball(.05), options)) > .9);
}

TEST_CASE("prepare: a needle far thinner than a voxel is grown until edges turn around it, and named", "[prepare]") {
  RemeshOptions options;
  options.vertices = 300;
  TriangleSoup needle = shapes::box({0, 0, 0}, {1e6, 1, 1});
  TestContext context;
  const RemeshResult closed = remesh(needle, options, context);
  CHECK(closed.mesh.vertices.size() == 300);
  CHECK(closed.report.optimize.self_intersections == 0);
  CHECK(std::any_of(closed.report.warnings.begin(), closed.report.warnings.end(),
                    [](const std::string& w) { return w.find("the surface is a needle") == 0; }));
  needle.triangles.resize(needle.triangles.size() - 2);  // without one of its long sides
  CHECK(remesh(needle, options, context).mesh.vertices.size() == 300);
}

TEST_CASE("prepare: more handles than vertices can show are closed, and it is said", "[prepare]") {
  RemeshOptions options;
  options.vertices = 400;
  options.features.creases = Features::Creases::off;
  const TriangleSoup sieve = shapes::sieve(9, 1, 1, 1);
  TestContext context;
  const RemeshResult few = remesh(sieve, options, context);
  CHECK(few.report.input.topology.genus == 81);
  CHECK(few.report.grid.grown_vox > 0);
  CHECK(few.report.sheet.topology.genus < 81);
  REQUIRE(few.report.warnings.size() == 1);
  CHECK(few.report.warnings[0].find("81 handles are more than so few vertices can show") != std::string::npos);
  CHECK(check_mesh(few.mesh).is_closed_manifold());
  CHECK(few.report.optimize.self_intersections == 0);
  options.vertices = 3000;
  const PreparedRun all = prepare_with(sieve, options);
  CHECK(all.report.grid.grown_vox == 0);
  CHECK(all.report.sheet.agrees);
}

TEST_CASE("prepare: a slot closes when its width is asked for, and stays open from four voxels below on", "[prepare]") {
  constexpr int32_t kResolution = 100;
  const double voxel = 2. / (kResolution - 1);
  for (const int width_vox : {1, 2, 3, 5, 8, 12, 16}) {
    const TriangleSoup ball = slotted_ball(width_vox * voxel);
    for (const int requested_vox : {width_vox, width_vox - 4, 0}) {
      if (requested_vox < 0) continue;
      RemeshOptions options;
      options.resolution = kResolution;
      options.closing_world = requested_vox * voxel;
      options.vertices = requested_vox == width_vox ? 10000 : 2500;  // walls grow as far as edges are long
      const PreparedRun run = prepare_with(ball, options);
      INFO("slot of " << width_vox << " voxels, closing " << requested_vox << ", volume " << volume_in_balls(run));
      CHECK(run.report.input.repair.capped_loops == 0);
      if (requested_vox == width_vox) {
        CHECK(volume_in_balls(run) > .9);
        GapReport gaps;
        const std::vector<uint8_t> bridges = find_bridges(run.prepared.sites(), run.prepared.sheet());
        measure_bridges(run.prepared.sheet(), bridges, gaps);
        const std::vector<Voxel> voxels = bridging_voxels(run.prepared.sheet(), bridges);
        CHECK(voxels.empty() == (std::count(bridges.begin(), bridges.end(), 1) == 0));
        const SiteSet sites = to_host(run.prepared.sites());
        for (const Voxel v : voxels) CHECK(find_voxel(sites.voxels.view(), v) < 0);
        if (width_vox >= 4) CHECK(gaps.bridges == 1);
        if (width_vox >= 4) CHECK(gaps.widest_bridge_world / voxel == Approx(width_vox).margin(1.2 + .08 * width_vox));
      }
      if (requested_vox <= width_vox - 4) CHECK(volume_in_balls(run) < .5);
    }
    RemeshOptions automatic;
    automatic.resolution = kResolution;
    const PreparedRun run = prepare_with(ball, automatic);
    CHECK(run.report.input.repair.capped_loops == 1);
    CHECK(run.report.grid.closing_vox == 0);
    CHECK(volume_in_balls(run) > .9);
  }
}

TEST_CASE("prepare: options out of range are refused with their name", "[prepare][stage]") {
  const TriangleSoup box = shapes::box({0, 0, 0}, {1, 1, 1});
  struct Case {
    const char* name;
    void (*spoil)(RemeshOptions&);
  };
  const Case cases[] = {
      {"vertices", [](RemeshOptions& o) { o.vertices = 3; }},
      {"edge_length_world", [](RemeshOptions& o) { o.edge_length_world = std::nan(""); }},
      {"resolution", [](RemeshOptions& o) { o.resolution = 7; }},
      {"voxel_size_world", [](RemeshOptions& o) { o.voxel_size_world = -1; }},
      {"band_vox", [](RemeshOptions& o) { o.band_vox = kMaxBandVox + 1; }},
      {"closing_vox", [](RemeshOptions& o) { o.closing_vox = kMaxClosingVox + 1; }},
      {"max_passes", [](RemeshOptions& o) { o.max_passes = -1; }},
      {"tolerance", [](RemeshOptions& o) { o.tolerance = 2; }},
      {"max_step_vox", [](RemeshOptions& o) { o.max_step_vox = 1e300; }},
      {"adaptivity", [](RemeshOptions& o) { o.adaptivity = 1.5; }},
      {"gradation", [](RemeshOptions& o) { o.gradation = 1; }},
      {"method sheet", [](RemeshOptions& o) { o.method = Method::shell, o.adaptivity = .5; }},
      {"a gap of 1e+30", [](RemeshOptions& o) { o.closing_world = 1e30; }},
  };
  for (const Case& c : cases) {
    RemeshOptions options;
    c.spoil(options);
    INFO(c.name);
    CHECK(contains(message_of(ErrorCode::usage, [&] { prepare_with(box, options); }), c.name));
  }
}

TEST_CASE("relax: an asked tolerance holds, also one that is the default of a single level", "[relax][stage]") {
  RemeshOptions options;
  options.vertices = 600;
  const auto passes = [&](double tolerance, int32_t most) {
    options.tolerance = tolerance;
    options.max_passes = most;
    TestContext context;
    const Prepared prepared = prepare(shapes::torus(2, .7, 60, 30), options, context);
    return relax(prepared, context).report.relax.passes;
  };
  CHECK(passes(1, 0) < passes(-1, 0));
  CHECK(passes(-1, 0) < passes(1e-5, 0));
  CHECK(passes(0, 7) == 7);
}

TEST_CASE("triangulate: goes on from a copy of the seeds after it was cancelled", "[triangulate][stage]") {
  RemeshOptions options;
  options.vertices = 300;
  TestContext context;
  const Prepared prepared = prepare(shapes::torus(2, 0.7, 80, 35), options, context);
  const Relaxed relaxed = relax(prepared, context);
  const auto mesh = [&] { return triangulate(prepared, {to_host(relaxed.seeds), relaxed.report}, context).mesh; };
  context.cancel = true;
  CHECK_THROWS_AS(mesh(), Error);
  context.cancel = false;
  CHECK(mesh().vertices.size() == 300);
}
