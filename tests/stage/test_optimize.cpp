// The optimisation on sheets of many shapes: the mesh stays what it is, and its triangles get better.
#include <algorithm>
#include <cmath>

#include "cpu/executor_tbb.h"
#include "isoshell/advanced/stages.h"
#include "isoshell/mesh_topology.h"
#include "isoshell/quality.h"
#include "stages/halfedge/planes.h"
#include "stages/optimize/optimize_body.h"
#include "stages/optimize/optimize_chords.h"
#include "support/catch.h"
#include "support/relax_sheets.h"
#include "support/shapes.h"
#include "support/solid_soup.h"
#include "support/test_context.h"

using namespace isoshell;

namespace {

/// Duals of seeds that were relaxed a little, or not at all.
std::vector<DualStart> starts() {
  std::vector<DualStart> out;
  const auto add = [&](const char* name, const TriangleSoup& soup, int32_t resolution, int64_t count, int32_t passes) {
    out.push_back(dual_start(name, soup, resolution, count, passes));
  };
  add("torus", shapes::torus(2, 0.7, 160, 70), 256, 400, 20);
  add("torus, not relaxed", shapes::torus(2, 0.7, 160, 70), 256, 400, 0);
  add("sphere", shapes::sphere({0, 0, 0}, 1, 60), 320, 300, 10);
  add("frame of a cube, genus 5", shapes::cube_frame(12, 2), 24, 150, 5);
  add("frame of a cube, too few seeds", shapes::cube_frame(12, 2), 24, 60, 5);
  add("sieve, genus 9", shapes::sieve(3, 2, 2, 2), 28, 80, 5);
  add("two bodies", shapes::together(shapes::torus(2, 0.5, 100, 40), shapes::sphere({0, 0, 2}, 0.5, 24)), 400, 200, 5);
  return out;
}

double least_quality(const DualMesh& mesh) {
  double least = 2;
  for (const TriangleIndices& t : mesh.triangles)
    least = std::min(least, optimize::quality_of(mesh.position[t.a], mesh.position[t.b], mesh.position[t.c]));
  return least;
}

/// Root mean square of the distances of the sheet's vertices to the mesh, by brute force.
double distance_q8(const Sheet& sheet, const DualMesh& mesh) {
  double sum = 0;
  for (const PointQ8& p : sheet.position) {
    int64_t best = INT64_MAX;
    for (const TriangleIndices& t : mesh.triangles)
      best = std::min(best, distance_sq_q16(p, closest_point_on_triangle(p, mesh.position[t.a], mesh.position[t.b],
                                                                         mesh.position[t.c])));
    sum += double(best);
  }
  return std::sqrt(sum / double(sheet.vertex_count()));
}

}  // namespace

TEST_CASE("optimize: the mesh stays closed, of its topology and in canonical order", "[optimize][stage]") {
  TestContext context;
  for (DualStart& s : starts()) {
    const MeshTopology before = check_mesh(s.mesh.triangles.view(), s.mesh.position.size());
    optimize_mesh(s.sheet, {}, s.seeds, s.mesh, context);
    const MeshTopology after = check_mesh(s.mesh.triangles.view(), s.mesh.position.size());
    INFO(s.name);
    CHECK(after.is_closed_manifold());
    CHECK(after.components == before.components);
    CHECK(after.genus == before.genus);
    CHECK(std::equal(s.mesh.position.begin(), s.mesh.position.end(), s.seeds.position.begin(), s.seeds.position.end()));
    for (int64_t t = 0; t < s.mesh.triangles.size(); ++t) {
      const TriangleIndices i = s.mesh.triangles[t];
      CHECK((i.a < i.b && i.a < i.c));
      if (t == 0) continue;
      const TriangleIndices j = s.mesh.triangles[t - 1];
      CHECK((j.a != i.a ? j.a < i.a : (j.b != i.b ? j.b < i.b : j.c < i.c)));
    }
  }
}

TEST_CASE("optimize: the CPU's own ways of steps give what their definitions give", "[optimize][stage]") {
  for (const DualStart& s : starts())
    for (const bool uniform_area : {false, true}) {
      INFO(s.name << (uniform_area ? ", uniform areas" : ""));
      TestContext context;
      OptimizeOptions options;
      options.uniform_area = uniform_area;
      SeedSet seeds = to_host(s.seeds), seeds_by_definition = to_host(s.seeds);
      DualMesh mesh = copy_of(s.mesh), mesh_by_definition = copy_of(s.mesh);
      optimize_mesh(s.sheet, options, seeds, mesh, context);
      PlainExecutor exec(context, "test");
      optimize_mesh_body(exec, s.sheet, options, seeds_by_definition, mesh_by_definition);
      CHECK(same(mesh, mesh_by_definition));
    }
}

TEST_CASE("optimize: triangles get better on average, and the worst one no worse", "[optimize][stage]") {
  TestContext context;
  for (DualStart& s : starts()) {
    const double least = least_quality(s.mesh);
    const MeshQuality before = measure_quality(to_world(s.mesh, s.sheet.frame));
    optimize_mesh(s.sheet, {}, s.seeds, s.mesh, context);
    const MeshQuality after = measure_quality(to_world(s.mesh, s.sheet.frame));
    INFO(s.name << ": least quality " << least << " -> " << least_quality(s.mesh));
    CHECK(least_quality(s.mesh) >= least);
    CHECK(after.q_avg > before.q_avg);
    CHECK(after.irregular_ratio <= before.irregular_ratio);
  }
}

TEST_CASE("optimize: smooth shapes get no angle below 38 degrees", "[optimize][stage]") {
  TestContext context;
  for (DualStart& s : starts()) {
    if (s.name != "torus" && s.name != "sphere") continue;
    optimize_mesh(s.sheet, {}, s.seeds, s.mesh, context);
    INFO(s.name);
    CHECK(measure_quality(to_world(s.mesh, s.sheet.frame)).theta_min_deg >= 38);
  }
}

TEST_CASE("optimize: vertices that are to be seeds again end on the sheet, in better triangles", "[optimize][stage]") {
  TestContext context;
  OptimizeOptions options;
  options.for_seeds = true;
  for (DualStart& s : starts()) {
    const double before = measure_quality(to_world(s.mesh, s.sheet.frame)).q_avg;
    optimize_mesh(s.sheet, options, s.seeds, s.mesh, context);
    INFO(s.name);
    CHECK(measure_quality(to_world(s.mesh, s.sheet.frame)).q_avg > before);
    for (int64_t v = 0; v < s.mesh.position.size(); ++v) {
      int64_t least = INT64_MAX;
      for (const TriangleIndices& t : s.sheet.triangles)
        least = std::min(least, distance_sq_q16(s.mesh.position[v], closest_point_on_triangle(
                                                                        s.mesh.position[v], s.sheet.position[t.a],
                                                                        s.sheet.position[t.b], s.sheet.position[t.c])));
      REQUIRE(least <= 3);  // a corner of the lattice away
    }
  }
}

TEST_CASE("optimize: flips alone move nothing and make valences more even", "[optimize][stage]") {
  TestContext context;
  for (DualStart& s : starts()) {
    SeedSet seeds = to_host(s.seeds);
    DualMesh mesh = copy_of(s.mesh);
    const int64_t flips = optimize_mesh(s.sheet, {6, 0, 0}, seeds, mesh, context).flips;
    const auto unevenness = [](const DualMesh& m) {
      std::vector<int> valence(size_t(m.position.size()));
      for (const TriangleIndices& t : m.triangles) ++valence[t.a], ++valence[t.b], ++valence[t.c];
      int64_t sum = 0;
      for (const int v : valence) sum += int64_t(v - 6) * (v - 6);
      return sum;
    };
    INFO(s.name);
    CHECK(std::equal(mesh.position.begin(), mesh.position.end(), s.mesh.position.begin()));
    CHECK(unevenness(mesh) <= unevenness(s.mesh) - 2 * flips);
  }
}

TEST_CASE("optimize: one thread and two give the same bytes", "[optimize][stage]") {
  for (DualStart& s : starts()) {
    DualMesh first;
    for (const int threads : {1, 2}) {
      TestContext context;
      context.threads = threads;
      SeedSet seeds = to_host(s.seeds);
      DualMesh mesh = copy_of(s.mesh);
      optimize_mesh(s.sheet, {}, seeds, mesh, context);
      INFO(s.name);
      if (threads == 1)
        first = std::move(mesh);
      else
        CHECK(same(first, mesh));
    }
  }
}

TEST_CASE("optimize: a balanced fit is nearer to the surface than vertices on it, which surface gives",
          "[optimize][stage]") {
  TestContext context;
  for (DualStart& s : starts()) {
    if (s.name == "torus, not relaxed") continue;
    if (s.name == "frame of a cube, too few seeds") continue;  // triangles intersect, and go back to where they began
    INFO(s.name);
    OptimizeOptions options;
    double distance[2];
    for (const Fit fit : {Fit::balanced, Fit::surface}) {
      options.fit = fit;
      SeedSet seeds = to_host(s.seeds);
      DualMesh mesh = copy_of(s.mesh);
      optimize_mesh(s.sheet, options, seeds, mesh, context);
      distance[int(fit)] = distance_q8(s.sheet, mesh);
      if (fit == Fit::balanced) continue;
      for (const PointQ8& p : mesh.position) {
        int64_t best = INT64_MAX;
        for (const TriangleIndices& t : s.sheet.triangles)
          best = std::min(best,
                          distance_sq_q16(p, closest_point_on_triangle(p, s.sheet.position[t.a], s.sheet.position[t.b],
                                                                       s.sheet.position[t.c])));
        CHECK(best <= 3);  // rounding
      }
    }
    CHECK(distance[0] < 0.8 * distance[1]);
  }
}

TEST_CASE("optimize: points that the sheet misses draw the mesh towards them", "[optimize][stage]") {
  TriangleSoup soup = shapes::sphere({0, 0, 0}, 1, 60);
  WorldPoint& pit = soup.vertices[soup.vertices.size() / 2 + 3];
  pit = {0.8 * pit.x, 0.8 * pit.y, 0.8 * pit.z};
  TestContext context;
  const LatticeFrame frame = LatticeFrame::around({-1, -1, -1}, {1, 1, 1}, 80);
  LatticeSurface surface = snap_surface(soup, frame, context);
  surface.topology.closed = surface.topology.oriented = true;
  const SiteSet sites = voxelize(surface, context);
  Sheet sheet = build_sheet(surface, sites, sample_sites(surface, sites, context), {}, context);
  SeedSet seeds = place_seeds(sheet, {300, 3}, context);
  relax_on_sheet(sheet, seeds, {20}, context);
  DualReport report;
  const DualMesh start = triangulate_dual(sheet, seeds, {}, report, context);
  REQUIRE(report.failed_cells == 0);
  REQUIRE(!sheet.missed.empty());
  const auto distance_of_pit = [&] {
    SeedSet s = to_host(seeds);
    DualMesh mesh = copy_of(start);
    optimize_mesh(sheet, {}, s, mesh, context);
    const PointQ8 bottom = frame.snap(pit);
    int64_t best = INT64_MAX;
    for (const TriangleIndices& t : mesh.triangles)
      best = std::min(best, distance_sq_q16(bottom, closest_point_on_triangle(bottom, mesh.position[t.a],
                                                                              mesh.position[t.b], mesh.position[t.c])));
    return std::sqrt(double(best));
  };
  const double seen = distance_of_pit();
  sheet.missed = {};
  sheet.missed_vertex = {};
  CHECK(seen < 0.8 * distance_of_pit());
}

TEST_CASE("optimize: an edge far from the surface is flipped where that brings it nearer", "[optimize]") {
  TestContext context;
  PlainExecutor exec(context, "test");
  constexpr uint32_t kAround = 4;  // vertices around the tube
  const TriangleSoup soup = shapes::torus(3000, 1500, 16, kAround);
  // An edge along the outside of the tube, and the corners opposite of it, above and below.
  const uint32_t a = kAround, b = 2 * kAround, c = 2 * kAround + 1, d = 2 * kAround - 1;
  const auto snapped = [](WorldPoint p) {
    return PointQ8{int32_t(std::lround(p.x)), int32_t(std::lround(p.y)), int32_t(std::lround(p.z))};
  };
  const auto middle = [&](uint32_t u, uint32_t v) {
    const WorldPoint p = soup.vertices[u], q = soup.vertices[v];
    return WorldPoint{(p.x + q.x) / 2, (p.y + q.y) / 2, (p.z + q.z) / 2};
  };
  const auto flips_for_sample_at = [&](WorldPoint at) {
    DualMesh mesh{Buffer<PointQ8>(int64_t(soup.vertices.size())),
                  Buffer<TriangleIndices>(int64_t(soup.triangles.size()))};
    std::transform(soup.vertices.begin(), soup.vertices.end(), mesh.position.begin(), snapped);
    std::transform(soup.triangles.begin(), soup.triangles.end(), mesh.triangles.begin(), [](const auto& t) {
      return TriangleIndices{t[0], t[1], t[2]};
    });
    optimize::Connections connections(exec, mesh);
    const optimize::MeshView view = connections.view(mesh);
    uint32_t edge = 0;
    while (view.from(edge) != a || view.to(edge) != b) ++edge;
    REQUIRE(view.opposite(edge) == c);
    REQUIRE(view.opposite(view.twin[edge]) == d);

    Buffer<optimize::FitSample> sample(1);
    sample[0] = {snapped(at), {0, 0, 0}, false, edge / 3};
    const PointQ8 corners[3] = {mesh.position[a], mesh.position[b], mesh.position[c]};
    const optimize::Vector rest =
        optimize::foot_on_triangle(sample[0].position, corners[0], corners[1], corners[2]).rest;
    Buffer<int64_t> rest_sq(1);
    rest_sq[0] = int64_t(optimize::dot(rest, rest));
    Buffer<uint32_t> far(mesh.triangles.size()), now(view.twin.size), flipped(view.twin.size);
    exec.fill(far.view(), 0u);
    exec.fill(now.view(), 0u);
    exec.fill(flipped.view(), 0u);
    exec.for_each("mark", 1, optimize::MarkFarTriangles{sample.view(), rest_sq.view(), 250, far.view()});
    const optimize::ChordGaps gaps{now.view(), flipped.view()};
    exec.for_each("measure", 1, optimize::MeasureSamples{view, mesh.position.view(), sample.view(), far.view(), gaps});
    Buffer<uint64_t> claim(mesh.position.size());
    const int64_t flips =
        PlainKernels::FlipEdges::run(exec, optimize::ChordKey{view, mesh.position.view(), gaps, {}}, claim.view(), 1);
    CHECK(view.are_neighbours(c, d) == (flips > 0));
    CHECK(view.are_neighbours(a, b) == (flips == 0));
    return flips;
  };
  const WorldPoint inside = middle(c, d), outside = middle(a, b);
  CHECK(flips_for_sample_at(inside) == 1);
  CHECK(flips_for_sample_at(outside) == 0);                                        // on the edge
  CHECK(flips_for_sample_at({1.5 * outside.x, 1.5 * outside.y, outside.z}) == 0);  // far, and farther when flipped
}

TEST_CASE("optimize: a mesh without triangles stays one", "[optimize][stage]") {
  TestContext context;
  DualStart s = std::move(starts().front());
  SeedSet none;
  DualMesh empty;
  const OptimizeReport report = optimize_mesh(s.sheet, {}, none, empty, context);
  CHECK(report.flips == 0);
  CHECK(report.self_intersections == 0);
  CHECK(empty.triangles.empty());
}

TEST_CASE("optimize: moves are held to the planes of triangles, at creases and tips, not on smooth places",
          "[optimize]") {
  const auto held = [](const std::vector<optimize::Vector>& normals, optimize::Vector move) {
    optimize::PlanesAround planes;
    for (const optimize::Vector& n : normals) planes.add(n);
    return planes.holding(64).solve(move);
  };
  const optimize::Vector flat = held({{0, 0, 2}, {0, 0, 3}}, {4, 5, 0});
  CHECK(flat.x == Approx(4));
  CHECK(flat.y == Approx(5));
  const optimize::Vector smooth = held({{0.1, 0, 1}, {-0.1, 0, 1}, {0, 0.1, 1}, {0, -0.1, 1}}, {1, 0, 0});
  CHECK(smooth.x > 0.99);
  const optimize::Vector crease = held({{1, 0, 1}, {-1, 0, 1}}, {1, 1, 0});
  CHECK(crease.x < 0.1);
  CHECK(crease.y == Approx(1));
  const optimize::Vector tip = held({{1, 0, 0.5}, {-1, 0, 0.5}, {0, 1, 0.5}, {0, -1, 0.5}}, {1, 1, 0});
  CHECK(tip.x < 0.15);
  CHECK(tip.y < 0.15);
}

TEST_CASE("optimize: areas are more even when that is asked for", "[optimize][stage]") {
  TestContext context;
  for (DualStart& s : starts()) {
    if (s.name != "torus" && s.name != "sphere" && s.name != "two bodies") continue;
    double cv[2];
    for (const bool uniform : {false, true}) {
      OptimizeOptions options;
      options.uniform_area = uniform;
      SeedSet seeds = to_host(s.seeds);
      DualMesh mesh = copy_of(s.mesh);
      optimize_mesh(s.sheet, options, seeds, mesh, context);
      cv[int(uniform)] = measure_quality(to_world(mesh, s.sheet.frame)).area_cv;
    }
    INFO(s.name);
    CHECK(cv[1] < cv[0]);
  }
}
