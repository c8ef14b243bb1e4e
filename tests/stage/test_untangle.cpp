// Ways to a mesh without intersections: the sheet goes back to its lattice corners, cells around triangles that
// intersect are simplified, flips that would make triangles intersect are not made.
#include <algorithm>
#include <cmath>
#include <string>

#include "cpu/executor_tbb.h"
#include "isoshell/advanced/stages.h"
#include "isoshell/mesh_topology.h"
#include "isoshell/remesh.h"
#include "stages/halfedge/intersections.h"
#include "support/catch.h"
#include "support/shapes.h"
#include "support/test_context.h"
#include "voxel/random.h"

using namespace isoshell;

namespace {

int64_t count_intersections(const Sheet& sheet, const Buffer<TriangleIndices>& triangles,
                            const Buffer<PointQ8>& position) {
  Context context;
  PlainExecutor exec(context, "test");
  Buffer<uint32_t> marked(position.size());
  return run_with_threads(context, [&] {
    return optimize::find_intersections(exec, {triangles.view(), position.view()}, sheet.extent_vox, 4, marked.view());
  });
}

Sheet sheet_of(const TriangleSoup& soup, int32_t resolution, TestContext& context) {
  const auto [lo, hi] = bounding_box(soup);
  LatticeSurface surface = snap_surface(soup, LatticeFrame::around(lo, hi, resolution), context);
  const SiteSet sites = voxelize(surface, context);
  return build_sheet(surface, sites, sample_sites(surface, sites, context), {}, context);
}

/// Moves every vertex by up to so many voxels, 1 or more, along each axis.
void shake(Sheet& sheet, int32_t voxels) {
  for (int64_t v = 0; v < sheet.vertex_count(); ++v) {
    const uint64_t bits = random_bits(3, uint64_t(v));
    const auto by = [&](int shift) {
      return int32_t((bits >> shift) % uint64_t(2 * voxels * kOneVoxelQ8)) - voxels * kOneVoxelQ8;
    };
    sheet.position[v] = {sheet.position[v].x + by(0), sheet.position[v].y + by(20), sheet.position[v].z + by(40)};
  }
}

struct Meshed {
  SeedSet seeds;
  DualMesh mesh;
  DualReport report;
};
Meshed meshed(const Sheet& sheet, int64_t count, TestContext& context) {
  Meshed m;
  m.seeds = place_seeds(sheet, {count, 4}, context);
  relax_on_sheet(sheet, m.seeds, {20}, context);
  m.mesh = triangulate_dual(sheet, m.seeds, {}, m.report, context);
  REQUIRE(m.report.failed_cells == 0);
  return m;
}

/// A closed plate, bent in waves.
TriangleSoup wavy_plate(uint32_t n, double thickness) {
  TriangleSoup soup;
  for (const double side : {-0.5, 0.5})
    for (uint32_t i = 0; i < n; ++i)
      for (uint32_t j = 0; j < n; ++j) {
        const double u = 2.0 * i / (n - 1) - 1, v = 2.0 * j / (n - 1) - 1;
        soup.vertices.push_back({u, v, 0.25 * std::sin(7 * u) * std::cos(5 * v) + side * thickness});
      }
  const uint32_t top = n * n;
  const auto quad = [&](uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    soup.triangles.push_back({a, b, c});
    soup.triangles.push_back({a, c, d});
  };
  for (uint32_t i = 0; i + 1 < n; ++i)
    for (uint32_t j = 0; j + 1 < n; ++j) {
      const uint32_t a = i * n + j;
      quad(a, a + 1, a + n + 1, a + n);
      quad(top + a, top + a + n, top + a + n + 1, top + a + 1);
    }
  for (uint32_t i = 0; i + 1 < n; ++i) {
    const uint32_t x0 = i, x1 = i + 1, far = n * (n - 1);  // the sides u = -1 and 1
    quad(x0, top + x0, top + x1, x1);
    quad(far + x1, top + far + x1, top + far + x0, far + x0);
    const uint32_t y0 = i * n, y1 = y0 + n;  // v = -1 and 1
    quad(y1, top + y1, top + y0, y0);
    quad(y0 + n - 1, top + y0 + n - 1, top + y1 + n - 1, y1 + n - 1);
  }
  return soup;
}

/// Two voxels thick, on cells that are many voxels wide.
Sheet thin_sheet(TestContext& context) {
  Sheet sheet = sheet_of(wavy_plate(60, 0.07), 64, context);
  SeedSet few = place_seeds(sheet, {10, 1}, context);
  const UntangledSheet untangled = untangle_sheet(std::move(sheet), std::move(few), context);
  REQUIRE(untangled.self_intersections == 0);
  return to_host(untangled.sheet);
}
constexpr int64_t kFewSeeds = 170;

bool warns_of(const RemeshReport& report, const std::string& what) {
  return std::any_of(report.warnings.begin(), report.warnings.end(),
                     [&](const std::string& text) { return text.find(what) != std::string::npos; });
}

}  // namespace

TEST_CASE("untangle: a shaken sheet is left without intersections", "[dual][stage]") {
  TestContext context;
  for (const int32_t voxels : {1, 3}) {
    Sheet sheet = sheet_of(shapes::torus(2, 0.7, 40, 18), 60, context);
    shake(sheet, voxels);
    REQUIRE(count_intersections(sheet, sheet.triangles, sheet.position) > 1000);
    SeedSet seeds = place_seeds(sheet, {100, 1}, context);
    const UntangledSheet untangled = untangle_sheet(std::move(sheet), std::move(seeds), context);
    CHECK(untangled.self_intersections == 0);
    sheet = to_host(untangled.sheet);
    CHECK(count_intersections(sheet, sheet.triangles, sheet.position) == 0);
  }
}

TEST_CASE("untangle: only vertices of triangles that intersect move, and their seeds", "[dual][stage]") {
  TestContext context;
  const Sheet before = sheet_of(shapes::torus(2, 0.7, 40, 18), 60, context);
  REQUIRE(count_intersections(before, before.triangles, before.position) == 0);
  Sheet sheet = sheet_of(shapes::torus(2, 0.7, 40, 18), 60, context);
  SeedSet seeds = place_seeds(sheet, {300, 1}, context);
  const uint32_t pulled = seeds.home[7];  // through the tube and out of its other side
  PointQ8& p = sheet.position[pulled];
  const Normal8 n = sheet.normal[pulled];
  p = {p.x - 50 * n.x, p.y - 50 * n.y, p.z - 50 * n.z};
  REQUIRE(count_intersections(sheet, sheet.triangles, sheet.position) > 0);
  const std::vector<PointQ8> placed(seeds.position.begin(), seeds.position.end());
  const UntangledSheet untangled = untangle_sheet(std::move(sheet), std::move(seeds), context);
  CHECK(untangled.self_intersections == 0);
  sheet = to_host(untangled.sheet);
  seeds = to_host(untangled.seeds);
  int64_t moved = 0, seeds_moved = 0;
  for (int64_t v = 0; v < sheet.vertex_count(); ++v) moved += !(sheet.position[v] == before.position[v]);
  for (int64_t i = 0; i < seeds.size(); ++i) seeds_moved += !(seeds.position[i] == placed[size_t(i)]);
  CHECK(moved > 0);
  CHECK(moved < sheet.vertex_count() / 20);
  CHECK(seeds_moved < 15);
}

TEST_CASE("optimize: flips that would make more triangles intersect where vertices began are not made",
          "[optimize][stage]") {
  TestContext context;
  const Sheet sheet = thin_sheet(context);
  for (const bool keep_apart : {false, true}) {
    Meshed m = meshed(sheet, kFewSeeds, context);
    const int64_t before = count_intersections(sheet, m.mesh.triangles, m.mesh.position);
    OptimizeOptions options;
    options.keep_apart = keep_apart;
    options.smoothing_steps = 0;
    CHECK(optimize_mesh(sheet, options, m.seeds, m.mesh, context).flips > 0);
    m.mesh = to_host(m.mesh);
    const int64_t pairs = count_intersections(sheet, m.mesh.triangles, m.mesh.position);
    CHECK(check_mesh(m.mesh.triangles.view(), m.mesh.position.size()).is_closed_manifold());
    if (keep_apart)
      CHECK(pairs <= before);
    else
      CHECK(pairs > before);
  }
}

TEST_CASE("untangle: a thin wavy plate with few vertices becomes a mesh without intersections", "[dual][stage]") {
  RemeshOptions options;
  options.vertices = 200;
  options.features.creases = Features::Creases::off;  // patches are simplified instead
  for (const int threads : {1, 2}) {
    TestContext context;
    context.plain().threads = threads;
    const RemeshResult result = remesh(wavy_plate(60, 0.07), options, context.plain());
    CHECK(result.report.optimize.self_intersections == 0);
    CHECK(result.mesh.vertices.size() == 200);
    CHECK(warns_of(result.report, "vertices edges were collapsed"));
  }
}
