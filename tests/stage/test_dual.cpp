// The dual on sheets with few and badly placed seeds: every run must give the sheet's own topology.
#include "cpu/relax/label_simd.h"
#include "isoshell/advanced/stages.h"
#include "isoshell/error.h"
#include "isoshell/mesh_topology.h"
#include "oracle/dual_checks.h"
#include "stages/dual/dual_body.h"
#include "support/catch.h"
#include "support/shapes.h"
#include "support/solid_soup.h"
#include "support/soup_sheet.h"
#include "support/test_context.h"
#include "voxel/random.h"

using namespace isoshell;

namespace {

// The many small runs take one thread: on a busy machine, waiting for a second one costs more than it does.
constexpr int kThreads = 1;

struct NamedSheet {
  std::string name;
  Sheet sheet;
};

std::vector<NamedSheet> ugly_sheets() {
  std::vector<NamedSheet> out;
  const auto add = [&](const char* name, const TriangleSoup& soup, int32_t resolution) {
    const MeshTopology t = check_mesh({soup.vertices, soup.triangles});
    REQUIRE(t.is_closed_manifold());
    out.push_back({name, sheet_of_soup(soup, resolution, t.components, t.genus)});
  };
  add("torus", shapes::torus(2, 0.7, 60, 28), 160);
  add("thin torus", shapes::torus(2, 0.08, 160, 8), 320);
  add("sphere", shapes::sphere({0, 0, 0}, 1, 40), 320);
  add("frame of a cube, genus 5", shapes::cube_frame(12, 2), 24);
  add("frame of a cube, one voxel thick", shapes::cube_frame(12, 1), 24);
  add("sieve, genus 9", shapes::sieve(3, 2, 2, 2), 28);
  add("fine sieve, genus 25", shapes::sieve(5, 1, 1, 1), 22);
  add("rod", shapes::rod(60), 120);
  add("five cubes", shapes::cubes(5, 3), 40);
  add("single voxels", shapes::cubes(3, 1), 20);
  add("torus and sphere", shapes::together(shapes::torus(2, 0.5, 50, 20), shapes::sphere({0, 0, 2}, 0.5, 16)), 400);
  return out;
}

/// Seeds at random vertices, some twice, some off the sheet and facing the wrong way when `rough`.
SeedSet random_seeds(const Sheet& sheet, int64_t count, uint64_t generator, bool rough) {
  SeedSet seeds{Buffer<PointQ8>(count), Buffer<Normal8>(count), Buffer<uint32_t>(count), {}};
  for (int64_t s = 0; s < count; ++s) {
    const uint64_t bits = random_bits(generator, uint64_t(s));
    const int64_t v = int64_t(bits % uint64_t(sheet.vertex_count()));
    seeds.home[s] = uint32_t(v);
    seeds.position[s] = sheet.position[v];
    seeds.normal[s] = sheet.normal[v];
    if (rough && (bits >> 40) % 3 == 0) {
      seeds.position[s].x += int32_t(bits >> 50) % 1024;
      seeds.normal[s].y = int8_t(-seeds.normal[s].y);
    }
  }
  return seeds;
}

SeedSet copy_of(const SeedSet& seeds) {
  SeedSet out{Buffer<PointQ8>(seeds.size()), Buffer<Normal8>(seeds.size()), Buffer<uint32_t>(seeds.size()), {}};
  std::copy(seeds.position.begin(), seeds.position.end(), out.position.begin());
  std::copy(seeds.normal.begin(), seeds.normal.end(), out.normal.begin());
  std::copy(seeds.home.begin(), seeds.home.end(), out.home.begin());
  return out;
}

struct Labelled {
  std::vector<uint32_t> label;
  std::vector<std::array<uint32_t, 3>> faces;
  DualReport report;
};
/// By the body as the CPU runs it.
Labelled partition(const Sheet& sheet, SeedSet& seeds, int32_t max_rounds) {
  TestContext context;
  context.threads = kThreads;
  CpuExecutor exec(context, "dual");
  return run_with_threads(context, [&] {
    Labelled out;
    dual::Partition<CpuExecutor> cells(exec, sheet, seeds, {max_rounds}, out.report);
    for (const TriangleIndices& f : cells.repair()) out.faces.push_back({f.a, f.b, f.c});
    std::sort(out.faces.begin(), out.faces.end());
    out.label.assign(cells.label().begin(), cells.label().end());
    return out;
  });
}

bool same(const DualMesh& a, const DualMesh& b) {
  return a.position.size() == b.position.size() && a.triangles.size() == b.triangles.size() &&
         std::equal(a.position.begin(), a.position.end(), b.position.begin()) &&
         std::equal(a.triangles.begin(), a.triangles.end(), b.triangles.begin());
}

}  // namespace

TEST_CASE("dual: any seeds on any sheet give a closed manifold of the sheet's topology", "[dual][stage]") {
  TestContext context;
  context.threads = kThreads;
  int64_t most_rounds = 0;
  for (const NamedSheet& named : ugly_sheets()) {
    const Sheet& sheet = named.sheet;
    for (int64_t count : {1, 2, 4, 7, 20, 60, 200})
      for (uint64_t generator = 0; generator < 6; ++generator) {
        if (count > sheet.vertex_count()) continue;
        SeedSet seeds = random_seeds(sheet, count, generator * 1000 + uint64_t(count), generator % 2 == 1);
        DualReport report;
        const DualMesh mesh = triangulate_dual(sheet, seeds, {}, report, context);
        const MeshTopology t = check_mesh(mesh.triangles.view(), mesh.position.size());
        most_rounds = std::max(most_rounds, report.repair_rounds);
        INFO(named.name << ", " << count << " seeds, generator " << generator);
        CHECK(report.failed_cells == 0);
        CHECK(t.is_closed_manifold());
        CHECK(t.components == sheet.topology.components);
        CHECK(t.genus == sheet.topology.genus);
        CHECK(seeds.size() == count + report.inserted_seeds);
        CHECK(mesh.position.size() == seeds.size());
      }
  }
  INFO("rounds " << most_rounds);
  CHECK(most_rounds < 64);
}

TEST_CASE("dual: the repaired labels pass the four checks by brute force", "[dual][stage]") {
  for (const NamedSheet& named : ugly_sheets())
    for (int64_t count : {1, 5, 50}) {
      if (count > named.sheet.vertex_count()) continue;
      SeedSet seeds = random_seeds(named.sheet, count, uint64_t(count) + 77, true);
      const Labelled found = partition(named.sheet, seeds, 64);
      const oracle::DualChecks checks = oracle::check_labels(named.sheet, found.label, seeds.size());
      INFO(named.name << ", " << count << " seeds");
      CHECK(found.report.failed_cells == 0);
      CHECK(checks.all_pass());
      CHECK(checks.faces == found.faces);
      CHECK(std::adjacent_find(found.faces.begin(), found.faces.end()) == found.faces.end());
    }
}

TEST_CASE("dual: without rounds nothing is changed and failures are found exactly when there are some",
          "[dual][stage]") {
  int64_t passed = 0, failed = 0;
  for (const NamedSheet& named : ugly_sheets())
    for (int64_t count : {3, 30, 150}) {
      if (count > named.sheet.vertex_count()) continue;
      SeedSet seeds = random_seeds(named.sheet, count, 5, true);
      const Labelled found = partition(named.sheet, seeds, 0);
      const oracle::DualChecks checks = oracle::check_labels(named.sheet, found.label, count);
      INFO(named.name << ", " << count << " seeds");
      CHECK((found.report.failed_cells == 0) == checks.all_pass());
      CHECK(found.faces == checks.faces);
      CHECK(found.report.inserted_seeds == 0);
      CHECK(found.report.relabelled_vertices == 0);
      CHECK(found.report.repair_rounds == 0);
      CHECK(seeds.size() == count);
      (checks.all_pass() ? passed : failed) += 1;
    }
  CHECK(failed > 0);
}

TEST_CASE("dual: evenly relaxed seeds on smooth sheets need no repair", "[dual][stage]") {
  TestContext context;
  const Sheet sheet = sheet_of_soup(shapes::torus(2, 0.7, 160, 70), 256, 1, 1);
  SeedSet seeds = place_seeds(sheet, {400, 1}, context);
  relax_on_sheet(sheet, seeds, {40}, context);
  DualReport report;
  const DualMesh mesh = triangulate_dual(sheet, seeds, {}, report, context);
  CHECK(report.inserted_seeds == 0);
  CHECK(report.repair_rounds == 0);
  CHECK(check_mesh(mesh.triangles.view(), 400).is_closed_manifold());
  CHECK(std::equal(mesh.position.begin(), mesh.position.end(), seeds.position.begin()));
}

TEST_CASE("dual: thin walls of a voxelised surface keep their genus with few seeds", "[dual][stage]") {
  TestContext context;
  context.threads = kThreads;
  const TriangleSoup soups[] = {shapes::torus(2, 0.25, 90, 24), shapes::sieve(3, 3, 2, 1), shapes::cube_frame(14, 2)};
  for (const TriangleSoup& soup : soups) {
    const auto [lo, hi] = bounding_box(soup);
    const LatticeSurface surface = snap_surface(soup, LatticeFrame::around(lo, hi, 60), context);
    const SiteSet sites = voxelize(surface, context);
    const Sheet sheet = build_sheet(surface, sites, sample_sites(surface, sites, context), {}, context);
    for (int64_t count : {8, 60, 400})
      for (int32_t passes : {0, 10}) {
        SeedSet seeds = place_seeds(sheet, {count, 3}, context);
        if (passes > 0) relax_on_sheet(sheet, seeds, {passes}, context);
        DualReport report;
        const DualMesh mesh = triangulate_dual(sheet, seeds, {}, report, context);
        const MeshTopology t = check_mesh(mesh.triangles.view(), mesh.position.size());
        CHECK(report.failed_cells == 0);
        CHECK(t.is_closed_manifold());
        CHECK(t.components == sheet.topology.components);
        CHECK(t.genus == sheet.topology.genus);
        CHECK(t.genus == check_mesh({soup.vertices, soup.triangles}).genus);
      }
  }
}

TEST_CASE("dual: seeds that own nothing are given a place before new ones are made", "[dual][stage]") {
  TestContext context;
  const Sheet sheet = sheet_of_soup(shapes::sphere({0, 0, 0}, 1, 40), 320, 1, 0);
  SeedSet seeds = random_seeds(sheet, 40, 3, false);
  for (int64_t s = 20; s < 40; ++s) {
    seeds.position[s] = seeds.position[s - 20];
    seeds.normal[s] = seeds.normal[s - 20];
  }
  DualReport report;
  const DualMesh mesh = triangulate_dual(sheet, seeds, {}, report, context);
  CHECK(report.failed_cells == 0);
  CHECK(report.inserted_seeds == 0);
  const MeshTopology t = check_mesh(mesh.triangles.view(), mesh.position.size());
  CHECK(t.is_closed_manifold());
  CHECK(mesh.position.size() == 40);
}

TEST_CASE("dual: one and two threads give the same bytes, and so does a second run", "[dual][parity]") {
  for (const NamedSheet& named : ugly_sheets()) {
    const SeedSet start = random_seeds(named.sheet, std::min<int64_t>(40, named.sheet.vertex_count()), 9, true);
    TestContext one, two;
    one.threads = 1;
    two.threads = 2;
    DualReport report;
    SeedSet a = copy_of(start), b = copy_of(start), c = copy_of(start);
    const DualMesh first = triangulate_dual(named.sheet, a, {}, report, one);
    INFO(named.name);
    CHECK(same(first, triangulate_dual(named.sheet, b, {}, report, two)));
    CHECK(same(first, triangulate_dual(named.sheet, c, {}, report, two)));
    CHECK(std::equal(a.home.begin(), a.home.end(), b.home.begin(), b.home.end()));
  }
}

TEST_CASE("dual: more seeds than vertices, or none, is a usage error", "[dual][stage]") {
  TestContext context;
  const Sheet sheet = sheet_of_soup(shapes::rod(3), 20, 1, 0);
  DualReport report;
  SeedSet none, many = random_seeds(sheet, sheet.vertex_count() + 1, 1, false);
  CHECK_THROWS_AS(triangulate_dual(sheet, none, {}, report, context), Error);
  CHECK_THROWS_AS(triangulate_dual(sheet, many, {}, report, context), Error);
  SeedSet all = random_seeds(sheet, sheet.vertex_count(), 1, false);
  const DualMesh mesh = triangulate_dual(sheet, all, {}, report, context);
  CHECK(report.failed_cells == 0);
  CHECK(mesh.triangles.size() == sheet.triangles.size());
}
