// Collapsing and optimising meshes with borders: what is fixed stays, and what is joined is a manifold.
#include "cpu/executor_tbb.h"
#include "parity/product_hash.h"
#include "stages/dual/collapse_body.h"
#include "stages/optimize/optimize_body.h"
#include "support/catch.h"
#include "support/open_meshes.h"
#include "support/test_context.h"

using namespace isoshell;
using parity::hash_arrays;

namespace {

struct Meshed {
  FixedCase from;
  SurfaceMesh surface;
  SeedSet seeds;
  DualMesh mesh;
};
std::vector<Meshed> meshed(int64_t count, TestContext& context) {
  std::vector<Meshed> out;
  for (FixedCase& from : fixed_cases()) {
    Meshed m{std::move(from), {}, {}, {}};
    m.surface = surface_of(m.from.mesh, context);
    m.seeds = with_free_seeds(m.surface, fixed_on_borders(m.surface, m.from.is_seed), count);
    DualReport report;
    m.mesh = triangulate_dual(m.surface, m.seeds, {}, report, context);
    REQUIRE(report.failed_cells == 0);
    out.push_back(std::move(m));
  }
  return out;
}

void check_result(const Meshed& m, const SeedSet& before, const char* what) {
  INFO(m.from.mesh.name << ", " << what);
  check_fixed_unchanged(before, m.seeds);
  check_open_mesh(m.surface, m.seeds, m.mesh);
  check_joined(m.from, join_patches(m.mesh, m.seeds.fixed).mesh);
}

int64_t intersections_of(const Meshed& m) {
  Context context;
  PlainExecutor exec(context, "test");
  const DualMesh joined = join_patches(m.mesh, m.seeds.fixed).mesh;
  Buffer<uint32_t> marked(joined.position.size());
  return optimize::find_intersections(exec, {joined.triangles.view(), joined.position.view()}, m.surface.extent_vox, 4,
                                      marked.view());
}

/// Of the triangles around free vertices.
double mean_quality(const DualMesh& mesh) {
  double sum = 0;
  for (const TriangleIndices& t : mesh.triangles)
    sum += optimize::quality_of(mesh.position[t.a], mesh.position[t.b], mesh.position[t.c]);
  return sum / double(mesh.triangles.size());
}

/// That the free vertices of a cut box lie in the planes of their patches, to 1/16 voxel.
void check_on_patches(const Meshed& m) {
  if (m.from.corners.empty()) return;
  int64_t off = 0, farthest = 0;
  for (int64_t s = m.seeds.fixed.count; s < m.seeds.size(); ++s) {
    const uint32_t patch = m.surface.patch[m.seeds.home[s]];
    const auto& corner = m.from.corners[patch % 2 == 0 ? 0 : 7];
    const PointQ8 p = m.seeds.position[s];
    const int32_t at[3] = {p.x, p.y, p.z};
    off += std::abs(at[patch / 2] - corner[patch / 2]) > 16;
    farthest = std::max<int64_t>(farthest, std::abs(at[patch / 2] - corner[patch / 2]));
  }
  INFO(off << " are off, as far as " << farthest << " of 256");
  CHECK(off == 0);
}

}  // namespace

TEST_CASE("open optimize: triangles get better, what is fixed stays, and less intersects",
          "[open_optimize][optimize][stage][cuda]") {
  TestContext context;
  for (const Fit fit : {Fit::balanced, Fit::surface})
    for (Meshed& m : meshed(250, context)) {
      const SeedSet before = to_host(m.seeds);
      const double quality = mean_quality(m.mesh);
      const int64_t intersections = intersections_of(m);
      INFO(m.seeds.fixed.count << " fixed seeds, " << intersections << " intersections before");
      OptimizeOptions options;
      options.fit = fit;
      const OptimizeReport report = optimize_mesh(m.surface, options, m.seeds, m.mesh, context);
      check_result(m, before, "optimised");
      INFO(m.from.mesh.name);
      CHECK(mean_quality(m.mesh) > quality);
      CHECK(report.self_intersections == intersections_of(m));
      CHECK(report.self_intersections <= intersections);
      check_on_patches(m);
    }
}

TEST_CASE("open optimize: the same on every kernel set, with and without keeping apart",
          "[open_optimize][optimize][stage][parity][cuda]") {
  TestContext context;
  for (const bool keep_apart : {false, true})
    for (Meshed& m : meshed(150, context)) {
      INFO(m.from.mesh.name);
      SeedSet plain_seeds = to_host(m.seeds);
      DualMesh plain_mesh = to_host(m.mesh);
      OptimizeOptions options;
      options.keep_apart = keep_apart;
      optimize_mesh(m.surface, options, m.seeds, m.mesh, context);
      Context on_cpu;
      PlainExecutor exec(on_cpu, "test");
      optimize_mesh_body(exec, m.surface, options, plain_seeds, plain_mesh);
      CHECK(hash_arrays(m.mesh) == hash_arrays(plain_mesh));
      CHECK(hash_arrays(m.seeds) == hash_arrays(plain_seeds));
    }
}

TEST_CASE("open collapse: free vertices go, borders stay, and the topology with them",
          "[open_optimize][collapse][stage][cuda]") {
  TestContext context;
  for (Meshed& m : meshed(250, context))
    for (const int64_t part : {2, 8}) {
      const SeedSet before = to_host(m.seeds);
      const int64_t fixed = m.seeds.fixed.count, target = fixed + (m.seeds.size() - fixed) / part;
      SeedSet plain_seeds = to_host(m.seeds);
      DualMesh plain_mesh = to_host(m.mesh);
      collapse_edges(m.surface, target, m.seeds, m.mesh, context);
      CHECK(m.seeds.size() >= target);
      CHECK(m.seeds.size() < before.size());
      check_result(m, before, "collapsed");
      Context on_cpu;
      PlainExecutor exec(on_cpu, "test");
      collapse_edges_body(exec, m.surface, {target}, plain_seeds, plain_mesh);
      CHECK(hash_arrays(m.mesh) == hash_arrays(plain_mesh));
      OptimizeOptions options;
      optimize_mesh(m.surface, options, m.seeds, m.mesh, context);
      check_result(m, before, "collapsed and optimised");
    }
}

TEST_CASE("open optimize: the valences that fixed vertices want are those of their angles", "[open_optimize][stage]") {
  const auto vector = [](double degrees) {
    const double turn = degrees * 3.141592653589793 / 180;
    return optimize::Vector{1000 * std::cos(turn), 0, 1000 * std::sin(turn)};
  };
  for (double degrees = 0; degrees < 180; degrees += 0.5)
    CHECK(std::abs(optimize::angle_over_60(vector(10), vector(10 + degrees)) - degrees / 60) < 1e-4);
  CHECK(optimize::angle_over_60({5, 0, 0}, {-3, 0, 0}) == 3);
  CHECK(optimize::angle_over_60({0, 0, 0}, {-3, 0, 0}) == 0);
}
