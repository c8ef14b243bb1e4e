// prepare on surfaces without thickness, whose walls are grown.
#include <algorithm>
#include <cmath>

#include "isoshell/isoshell.h"
#include "pipeline/grid/prepared_surface.h"
#include "support/catch.h"
#include "support/prepared_run.h"
#include "support/shapes.h"
#include "support/solid_soup.h"
#include "support/test_context.h"
#include "voxel/leaf.h"

using namespace isoshell;

namespace {

/// A unit ball's surface with a hole below and a brim around that: a cap of the hole lies on the brim.
TriangleSoup hat() {
  constexpr uint32_t kAround = 96, kRows = 40, kAcross = 8;
  constexpr double kLowest = 2.7;  // angle from the pole
  TriangleSoup soup;
  for (uint32_t j = 1; j <= kRows + kAcross; ++j) {
    const double angle = kLowest * std::min(j, kRows) / kRows, brim = j <= kRows ? 0 : .25 * (j - kRows) / kAcross;
    for (uint32_t i = 0; i < kAround; ++i) {
      const double around = 6.283185307179586 * i / kAround, radius = std::sin(angle) + brim;
      soup.vertices.push_back({radius * std::cos(around), radius * std::sin(around), std::cos(angle)});
    }
  }
  const uint32_t top = uint32_t(soup.vertices.size());
  soup.vertices.push_back({0, 0, 1});
  for (uint32_t i = 0; i < kAround; ++i) {
    const uint32_t next = (i + 1) % kAround;
    shapes::add_triangle(soup, top, i, next);
    for (uint32_t j = 0; j + 1 < kRows + kAcross; ++j) {
      const uint32_t a = j * kAround + i, b = j * kAround + next;
      shapes::add_triangle(soup, a, a + kAround, b + kAround);
      shapes::add_triangle(soup, a, b + kAround, b);
    }
  }
  return soup;
}

}  // namespace

TEST_CASE("prepare: an open plate that closing makes solid stays as thin as it is", "[prepare]") {
  constexpr uint32_t kCells = 25;
  TriangleSoup plate = shapes::box({0, 0, 0}, {kCells, kCells, .5});
  const auto is_on_top = [&](const std::array<uint32_t, 3>& t) {
    return plate.vertices[t[0]].z > 0 && plate.vertices[t[1]].z > 0 && plate.vertices[t[2]].z > 0;
  };
  plate.triangles.erase(std::remove_if(plate.triangles.begin(), plate.triangles.end(), is_on_top),
                        plate.triangles.end());
  const uint32_t first = uint32_t(plate.vertices.size());
  for (uint32_t i = 0; i <= kCells; ++i)
    for (uint32_t j = 0; j <= kCells; ++j) plate.vertices.push_back({double(i), double(j), .5});
  for (uint32_t i = 0; i < kCells; ++i)
    for (uint32_t j = 0; j < kCells; ++j) {
      const uint32_t a = first + i * (kCells + 1) + j, c = a + kCells + 2;
      if (i != 12 || j != 12) shapes::add_triangle(plate, a, a + kCells + 1, c);
      shapes::add_triangle(plate, a, c, a + 1);
    }
  RemeshOptions options;
  options.vertices = 1000;
  options.resolution = 200;  // four voxels thick, less than half an edge
  options.closing_vox = 6;
  const PreparedRun run = prepare_with(plate, options);
  CHECK(run.report.grid.grown_vox == 0);
  TestContext context;
  CHECK(double(six_volume_vox(run.prepared.sheet(), context)) / 6 == Approx(200. * 200 * 4).epsilon(.1));
}

TEST_CASE("prepare: an open sheet of which closing fills a fold grows walls", "[prepare]") {
  TriangleSoup sheet;
  const auto row = [&](double x, double z) {
    for (const double y : {0., 1.}) sheet.vertices.push_back({x, y, z});
  };
  row(0, 0);
  row(.47, 0);
  row(.47, .24);
  row(.53, .24);  // six voxels wide
  row(.53, 0);
  row(1, 0);
  for (uint32_t a = 0; a + 3 < sheet.vertices.size(); a += 2) {
    shapes::add_triangle(sheet, a, a + 2, a + 3);
    shapes::add_triangle(sheet, a, a + 3, a + 1);
  }
  RemeshOptions options;
  options.vertices = 300;
  options.resolution = 100;
  options.closing_vox = 4;
  CHECK(prepare_with(sheet, options).report.grid.grown_vox > 0);
}

TEST_CASE("prepare: a bowl keeps its two sides apart, and says so", "[prepare]") {
  RemeshOptions options;
  options.vertices = 500;
  TriangleSoup bowl = shapes::sphere({0, 0, 0}, 1, 64);
  bowl.triangles.resize(bowl.triangles.size() / 2);
  const PreparedRun run = prepare_with(bowl, options);
  CHECK(PreparedParts::of(run.prepared).grown.distance_vox > 0);
  REQUIRE(run.report.warnings.size() == 1);
  CHECK(run.report.warnings[0].find("both of its sides") != std::string::npos);
  CHECK(run.report.sheet.topology.components == 1);
  TestContext context;
  const RemeshResult result = remesh(bowl, options, context);
  CHECK(result.mesh.gap.empty());
  CHECK(result.report.sheet.topology.bridged_vertices == 0);
  CHECK(result.report.optimize.self_intersections == 0);
  CHECK(check_mesh(result.mesh).is_closed_manifold());
  CHECK(measure_quality(result.mesh).theta_min_deg > 30);
  CHECK(measure_quality(result.mesh).q_avg > .92);
  const PreparedRun ball = prepare_with(shapes::sphere({0, 0, 0}, 1, 64), options);
  CHECK(PreparedParts::of(ball.prepared).grown.distance_vox == 0);
}

TEST_CASE("prepare: open parts of a solid get walls that edges turn around, the solid stays where it is", "[prepare]") {
  TriangleSoup ball_with_flag = shapes::sphere({0, 0, 0}, 1, 64);
  const uint32_t first = uint32_t(ball_with_flag.vertices.size());
  constexpr uint32_t kCells = 20;
  for (uint32_t i = 0; i <= kCells; ++i)
    for (uint32_t j = 0; j <= kCells; ++j) {
      const double x = .9 + 1.6 * i / kCells, z = 1. * j / kCells - .5;
      ball_with_flag.vertices.push_back({x, .1 * std::sin(6 * x), z});
    }
  for (uint32_t i = 0; i < kCells; ++i)
    for (uint32_t j = 0; j < kCells; ++j) {
      const uint32_t a = first + i * (kCells + 1) + j, c = a + kCells + 2;
      shapes::add_triangle(ball_with_flag, a, a + kCells + 1, c);
      shapes::add_triangle(ball_with_flag, a, c, a + 1);
    }
  RemeshOptions options;
  options.vertices = 2000;
  TestContext context;
  const RemeshResult result = remesh(ball_with_flag, options, context);
  CHECK(result.report.grid.grown_vox > 0);
  CHECK(result.report.optimize.self_intersections == 0);
  CHECK(check_mesh(result.mesh).is_closed_manifold());
  CHECK(check_mesh(result.mesh).genus == 0);
  CHECK(measure_quality(result.mesh).theta_min_deg > 30);
  CHECK(measure_quality(result.mesh).q_avg > .92);
  for (const WorldPoint& p : result.mesh.vertices)
    if (p.x < .8) CHECK(std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z) == Approx(1).epsilon(.01));
}

TEST_CASE("prepare: a solid with flaps keeps the points that its sheet misses", "[prepare]") {
  TriangleSoup crown = hat();
  WorldPoint& pit = crown.vertices[700];
  REQUIRE(pit.z > .6);
  pit = {.95 * pit.x, .95 * pit.y, .95 * pit.z};
  RemeshOptions options;
  options.vertices = 2000;
  options.resolution = 100;
  const PreparedRun run = prepare_with(crown, options);
  CHECK(run.report.input.repair.capped_loops == 1);
  REQUIRE(PreparedParts::of(run.prepared).grown.only_flaps);
  const Sheet sheet = to_host(run.prepared.sheet());
  const PointQ8 bottom = sheet.frame.snap(pit);
  int64_t at_pit = 0, on_brim = 0;
  for (int64_t i = 0; i < sheet.missed.size(); ++i) {
    at_pit += sheet.missed[i] == bottom;
    const WorldPoint p = sheet.frame.to_world(sheet.missed[i]),
                     v = sheet.frame.to_world(sheet.position[sheet.missed_vertex[i]]);
    CHECK(std::hypot(std::hypot(p.x - v.x, p.y - v.y), p.z - v.z) < 5 * sheet.frame.voxel_size);
    on_brim += p.z < -.85;
  }
  CHECK(at_pit == 1);
  CHECK(on_brim == 0);
}

TEST_CASE("prepare: a solid with flaps whose topology is not the input's says both", "[prepare]") {
  TriangleSoup ring = shapes::torus(1, .99, 96, 48);
  for (WorldPoint& p : ring.vertices) p.z += 4;
  RemeshOptions options;
  options.vertices = 2000;
  options.resolution = 150;
  options.features.creases = Features::Creases::off;
  const PreparedRun run = prepare_with(shapes::together(hat(), ring), options);
  REQUIRE(PreparedParts::of(run.prepared).grown.only_flaps);
  REQUIRE(run.report.sheet.is_compared);
  REQUIRE(run.report.sheet.topology.genus == 0);
  REQUIRE(run.report.warnings.size() == 2);
  CHECK(run.report.warnings[0].find("open and bound nothing") != std::string::npos);
  CHECK(run.report.warnings[1].find("2 components and genus 0, the input 2 and 1") != std::string::npos);
}

TEST_CASE("prepare: walls of what the widest closing does not close grow too", "[prepare]") {
  RemeshOptions options;
  options.resolution = 200;
  options.vertices = 500;
  options.closing_world = 2 * kMaxClosingVox * 2. / 199;
  TriangleSoup bowl = shapes::sphere({0, 0, 0}, 1, 64);
  bowl.triangles.resize(bowl.triangles.size() / 2);
  const PreparedRun run = prepare_with(bowl, options);
  CHECK(run.report.grid.closing_vox == kMaxClosingVox);
  CHECK(PreparedParts::of(run.prepared).grown.distance_vox > 2);
  CHECK(run.report.sheet.topology.components == 1);
  CHECK(run.report.sheet.topology.genus == 0);
}
