// Relaxation on the mesh: parts of Voronoi cells against their definition, edges that become Delaunay, and irregular
// vertices that cancel out.
#include <algorithm>
#include <cmath>
#include <random>

#include "cpu/executor_tbb.h"
#include "isoshell/advanced/stages.h"
#include "stages/optimize/optimize_body.h"
#include "support/catch.h"
#include "support/open_meshes.h"
#include "support/refusals.h"
#include "support/relax_sheets.h"
#include "support/shapes.h"
#include "support/solid_soup.h"
#include "support/test_context.h"

using namespace isoshell;
using optimize::Vector;

namespace {

std::vector<DualStart> starts() {
  std::vector<DualStart> out;
  out.push_back(dual_start("torus", shapes::torus(2, 0.7, 160, 70), 256, 400, 8));
  out.push_back(dual_start("sphere", shapes::sphere({0, 0, 0}, 1, 60), 320, 300, 8));
  out.push_back(dual_start("frame of a cube, genus 5", shapes::cube_frame(12, 2), 24, 150, 8));
  return out;
}

OptimizeOptions passes_only(int32_t passes, double noise_edges) {
  OptimizeOptions options;
  options.flip_rounds = 0;
  options.smoothing_steps = 0;
  options.for_seeds = true;
  options.mesh_passes = passes;
  options.noise_edges = noise_edges;
  return options;
}

int64_t irregular(const DualMesh& mesh) {
  std::vector<int> valence(size_t(mesh.position.size()));
  for (const TriangleIndices& t : mesh.triangles) ++valence[t.a], ++valence[t.b], ++valence[t.c];
  return std::count_if(valence.begin(), valence.end(), [](int n) { return n != 6; });
}

double distance(Vector a, Vector b) { return std::sqrt(optimize::dot(a - b, a - b)); }

}  // namespace

TEST_CASE("mesh passes: parts of a triangle add up to it, and those of an acute one are nearest to their corners",
          "[mesh_passes][optimize]") {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-1000, 1000);
  for (int n = 0; n < 200; ++n) {
    const Vector b{place(random), place(random), place(random)}, c{place(random), place(random), place(random)};
    const optimize::TriangleCells cells = optimize::cells_of_triangle(b, c);
    const Vector normal = optimize::cross(b, c);
    const double area = std::sqrt(optimize::dot(normal, normal)) / 2;
    CHECK(distance(2 * area * cells.normal, normal) < 1e-9 * area);
    const Vector corner[3] = {{0, 0, 0}, b, c};
    double areas = 0;
    Vector moment = {0, 0, 0};
    for (int k = 0; k < 3; ++k) {
      const optimize::CellPart& part = cells.part[k];
      CHECK(part.area > 0);
      areas += part.area;
      moment = moment + Vector{part.x, part.y, part.z} + part.area * corner[k];
    }
    CHECK(std::abs(areas - area) < 1e-9 * area);
    CHECK(distance(moment, (area / 3) * (b + c)) < 1e-6 * area);
    if (std::min({cells.cotangent[0], cells.cotangent[1], cells.cotangent[2]}) < 0) continue;
    constexpr int kGrid = 60;
    double nearest[3] = {0, 0, 0};
    for (int i = 0; i < kGrid; ++i)
      for (int j = 0; j < kGrid - i; ++j) {
        const Vector p = ((i + 1 / 3.0) / kGrid) * b + ((j + 1 / 3.0) / kGrid) * c;
        const double d[3] = {distance(p, corner[0]), distance(p, corner[1]), distance(p, corner[2])};
        nearest[std::min_element(d, d + 3) - d] += 2 * area / (double(kGrid) * (kGrid + 1));
      }
    for (int k = 0; k < 3; ++k) CHECK(std::abs(nearest[k] - cells.part[k].area) < 0.05 * area);
  }
}

TEST_CASE("mesh passes: the CPU's own way, its threads and the definition give the same, also where lengths vary",
          "[mesh_passes][optimize]") {
  for (DualStart& s : starts())
    for (const bool vary : {false, true}) {
      if (vary) s.sheet = with_lengths(std::move(s.sheet), 4);
      INFO(s.name << (vary ? ", lengths vary" : ""));
      TestContext context;
      const OptimizeOptions options = passes_only(50, 0.1);
      SeedSet seeds_by_definition = to_host(s.seeds);
      DualMesh by_definition = copy_of(s.mesh);
      PlainExecutor exec(context, "test");
      optimize_mesh_body(exec, s.sheet, options, seeds_by_definition, by_definition);
      CHECK_FALSE(same(by_definition, s.mesh));
      for (const int threads : {1, 2}) {
        context.threads = threads;
        SeedSet seeds = to_host(s.seeds);
        DualMesh mesh = copy_of(s.mesh);
        optimize_mesh(s.sheet, options, seeds, mesh, context);
        CHECK(same(mesh, by_definition));
      }
    }
}

TEST_CASE("mesh passes: edges become Delaunay, vertices stay on the sheet, and the topology stays",
          "[mesh_passes][optimize]") {
  TestContext context;
  for (DualStart& s : starts()) {
    INFO(s.name);
    const MeshTopology before = check_mesh(s.mesh.triangles.view(), s.mesh.position.size());
    optimize_mesh(s.sheet, passes_only(200, 0), s.seeds, s.mesh, context);
    const MeshTopology after = check_mesh(s.mesh.triangles.view(), s.mesh.position.size());
    CHECK(after.is_closed_manifold());
    CHECK(after.genus == before.genus);
    const WalkOntoSheet walk = walk_onto(s.sheet);
    for (int64_t v = 0; v < s.mesh.position.size(); ++v) {
      const PointQ8 p = s.mesh.position[v];
      CHECK(distance_sq_q16(walk.closest_around(s.seeds.home[v], p), p) <= 3);
    }
    if (s.name != "torus" && s.name != "sphere") continue;  // others have edges that no flip may take
    PlainExecutor exec(context, "test");
    optimize::Connections connections(exec, s.mesh);
    const optimize::MeshView view = connections.view(s.mesh);
    for (uint32_t h = 0; h < view.twin.size; ++h) {
      const auto cotangent = [&](uint32_t half_edge) {
        const PointQ8 c = s.mesh.position[view.opposite(half_edge)];
        const Vector p = optimize::from_to(c, s.mesh.position[view.from(half_edge)]),
                     q = optimize::from_to(c, s.mesh.position[view.to(half_edge)]);
        const Vector n = optimize::cross(p, q);
        return optimize::dot(p, q) / std::sqrt(optimize::dot(n, n));
      };
      CHECK(cotangent(h) + cotangent(view.twin[h]) > -0.05);  // but for the moves of the last passes
    }
  }
}

TEST_CASE("mesh passes: with noise that fades more irregular vertices cancel out", "[mesh_passes][optimize]") {
  TestContext context;
  DualStart s = dual_start("sphere", shapes::sphere({0, 0, 0}, 1, 60), 320, 600, 8);
  int64_t without = 0, with = 0;
  for (const double noise : {0.0, 0.1}) {
    SeedSet seeds = to_host(s.seeds);
    DualMesh mesh = copy_of(s.mesh);
    optimize_mesh(s.sheet, passes_only(1000, noise), seeds, mesh, context);
    (noise > 0 ? with : without) = irregular(mesh);
  }
  INFO(irregular(s.mesh) << " irregular vertices -> " << without << ", with noise " << with);
  CHECK(without <= irregular(s.mesh));
  CHECK(with < without * 9 / 10);
}

TEST_CASE("mesh passes: fixed vertices stay where they are, with the edges of their borders",
          "[mesh_passes][optimize]") {
  TestContext context;
  for (const FixedCase& from : fixed_cases()) {
    INFO(from.mesh.name);
    const SurfaceMesh surface = surface_of(from.mesh, context);
    SeedSet seeds = with_free_seeds(surface, fixed_on_borders(surface, from.is_seed), 250);
    DualReport report;
    DualMesh mesh = triangulate_dual(surface, seeds, {}, report, context);
    REQUIRE(report.failed_cells == 0);
    const SeedSet before = to_host(seeds);
    optimize_mesh(surface, passes_only(60, 0.1), seeds, mesh, context);
    check_fixed_unchanged(before, seeds);
    check_open_mesh(surface, seeds, mesh);
    check_joined(from, join_patches(mesh, seeds.fixed).mesh);
  }
}

TEST_CASE("mesh passes: only vertices that are to be seeds may be relaxed so", "[mesh_passes][optimize]") {
  TestContext context;
  DualStart s = dual_start("sphere", shapes::sphere({0, 0, 0}, 1, 60), 320, 100, 8);
  OptimizeOptions options;
  options.mesh_passes = 10;
  CHECK(contains(message_of(ErrorCode::usage, [&] { optimize_mesh(s.sheet, options, s.seeds, s.mesh, context); }),
                 "mesh_passes is 10"));
}
