// Stages on surfaces with borders: what works on them, against brute force, and what refuses them. And blocks of
// vertices: no result depends on them.
#include "core/copy_product.h"
#include "cpu/relax/label_simd.h"
#include "cpu/relax/pass_simd.h"
#include "isoshell/error.h"
#include "stages/optimize/optimize_body.h"
#include "stages/relax/relax_sheet_body.h"
#include "support/catch.h"
#include "support/open_surfaces.h"
#include "support/pass_results.h"
#include "support/refusals.h"
#include "support/relax_sheets.h"
#include "support/solid_soup.h"
#include "support/test_context.h"

using namespace isoshell;

namespace {

std::vector<NamedMesh> open_meshes() {
  return {patch(60, 50, 90), patch_with_holes(60, 50, 90), sphere_mesh(true, 30, 90, 5000)};
}

/// Where a walk from vertex to nearer vertex ends.
uint32_t walked(const SurfaceMesh& surface, const std::vector<std::set<uint32_t>>& neighbours, uint32_t from,
                PointQ8 p) {
  for (;;) {
    std::pair<int64_t, uint32_t> best{distance_sq_q16(surface.position[from], p), from};
    for (const uint32_t v : neighbours[from]) {
      const int64_t d = distance_sq_q16(surface.position[v], p);
      if (d < best.first || (d == best.first && v < best.second)) best = {d, v};
    }
    if (best.second == from) return from;
    from = best.second;
  }
}

template <class Call>
void check_refused(Call call) {
  const std::string message = message_of(ErrorCode::usage, call);
  CHECK(contains(message, "border"));
  CHECK(contains(message, "closed"));
}

/// What VertexBlocks states.
void check_blocks(const SurfaceMesh& surface) {
  const VertexBlocks& blocks = surface.blocks;
  REQUIRE(blocks.first.size() == blocks.count() + 1);
  CHECK(blocks.first[0] == 0);
  CHECK(blocks.first[blocks.count()] == surface.vertex_count());
  int64_t beyond = 0;
  for (int64_t b = 0; b < blocks.count(); ++b) {
    const int64_t size = blocks.first[b + 1] - blocks.first[b];
    CHECK(size > 0);
    CHECK(size <= VertexBlocks::kMostVertices);
    const auto reach = [&](uint32_t v) {
      const PointQ8 p = surface.position[v], c = blocks.centre[b];
      return std::max({std::abs(p.x - c.x), std::abs(p.y - c.y), std::abs(p.z - c.z)});
    };
    for (int64_t v = blocks.first[b]; v < blocks.first[b + 1]; ++v)
      for (int64_t n = surface.vertex_first[v]; n < surface.vertex_first[v + 1]; ++n) {
        const TriangleIndices t = surface.triangles[surface.vertex_triangles[n]];
        beyond += std::max({reach(t.a), reach(t.b), reach(t.c)}) >= VertexBlocks::kReachQ8;
      }
  }
  CHECK(beyond == 0);
}

}  // namespace

TEST_CASE("open surface: seeds are spread over it, and attached to what is nearest", "[open_surface][stage][cuda]") {
  TestContext context;
  for (const NamedMesh& from : open_meshes()) {
    INFO(from.name);
    const SurfaceMesh surface = surface_of(from, context);
    SeedSet seeds = place_seeds(surface, {200, 3}, context);
    REQUIRE(seeds.size() == 200);
    attach_to_sheet(surface, seeds, context);
    for (int64_t s = 0; s < seeds.size(); ++s) {
      int64_t nearest = INT64_MAX;
      for (const PointQ8& p : surface.position) nearest = std::min(nearest, distance_sq_q16(p, seeds.position[s]));
      CHECK(distance_sq_q16(surface.position[seeds.home[s]], seeds.position[s]) == nearest);
    }
    for (const int64_t count : {int64_t(3), surface.vertex_count() / 2 + 1})
      CHECK_THROWS_AS(place_seeds(surface, {count, 0}, context), Error);
  }
}

TEST_CASE("open surface: labels are those of brute force, and cells add up to the area", "[open_surface][stage]") {
  TestContext context;
  for (const NamedMesh& from : open_meshes()) {
    INFO(from.name);
    const SurfaceMesh surface = surface_of(from, context);
    PlainExecutor exec(context, "test");
    for (const int64_t count : {5, 60, 700}) {
      const SeedSet seeds = place_seeds(surface, {count, 1}, context);
      const SeedSpacing spacing = seed_spacing(exec, surface, count);
      const std::vector<uint32_t> expected = brute_force_labels(surface, seeds, spacing);
      CHECK(labels_by<PlainExecutor>(surface, seeds) == expected);
      CHECK(labels_by<CpuExecutor>(surface, seeds) == expected);
      const std::vector<int64_t> cells = cells_by<PlainExecutor>(surface, seeds);
      CHECK(cells_by<CpuExecutor>(surface, seeds) == cells);
      int64_t total = 0;
      for (size_t i = 0; i < size_t(4 * count); i += 4) total += cells[i];
      CHECK(std::abs(total - doubled_area(surface)) < 8 * surface.triangles.size());
    }
  }
}

TEST_CASE("open surface: walks pass along the border", "[open_surface][stage]") {
  Context context;
  for (const NamedMesh& from : open_meshes()) {
    INFO(from.name);
    const SurfaceMesh surface = surface_of(from, context);
    const auto neighbours = neighbours_in(surface.triangles, surface.vertex_count());
    const WalkOntoSheet walk = walk_onto(surface);
    int64_t wrong = 0;
    for (uint64_t i = 0; i < 2000; ++i) {
      const auto start = uint32_t(random_bits(1, i) % uint64_t(surface.vertex_count()));
      const PointQ8 p = surface.position[int64_t(random_bits(2, i) % uint64_t(surface.vertex_count()))];
      wrong += walk.nearest_vertex(start, p) != walked(surface, neighbours, start, p);
    }
    CHECK(wrong == 0);
  }
}

TEST_CASE("open surface: relaxation evens out its cells, the same on every kernel set",
          "[open_surface][relax][stage][cuda]") {
  TestContext context;
  for (const NamedMesh& from : open_meshes()) {
    INFO(from.name);
    const SurfaceMesh surface = surface_of(from, context);
    const SeedSet start = place_seeds(surface, {150, 7}, context);
    SeedSet seeds = host_copy(start), plain = host_copy(start);
    const RelaxReport report = relax_on_sheet(surface, seeds, {40, 0, 0}, context);
    CHECK(report.energy.back() < 0.8 * report.energy.front());
    Context on_cpu;
    PlainExecutor exec(on_cpu, "test");
    const RelaxReport expected = run_with_threads(on_cpu, [&] {
      return relax_on_sheet_body(exec, surface, plain, RelaxOptions{40, 0, 0});
    });
    CHECK(report.energy == expected.energy);
    CHECK(std::equal(seeds.position.begin(), seeds.position.end(), plain.position.begin()));
    CHECK(std::equal(seeds.home.begin(), seeds.home.end(), plain.home.begin()));
    const auto neighbours = neighbours_in(surface.triangles, surface.vertex_count());
    for (int64_t s = 0; s < seeds.size(); ++s)
      for (const uint32_t v : neighbours[seeds.home[s]])  // as near as a point of the surface that is half a unit off
        CHECK(std::sqrt(double(distance_sq_q16(surface.position[seeds.home[s]], seeds.position[s]))) <=
              std::sqrt(double(distance_sq_q16(surface.position[v], seeds.position[s]))) + 512);
  }
}

TEST_CASE("open surface: edge lengths reach along the border, and their means count every neighbour once",
          "[open_surface][lengths][stage][cuda]") {
  TestContext context;
  for (const NamedMesh& from : open_meshes()) {
    INFO(from.name);
    SurfaceMesh surface = surface_of(from, context);
    const auto neighbours = neighbours_in(surface.triangles, surface.vertex_count());
    constexpr int64_t kSlopeQ16 = 20000;
    std::vector<uint32_t> expected(size_t(surface.vertex_count()), 1 << 20);
    for (uint64_t i = 0; i < 5; ++i) expected[random_bits(4, i) % expected.size()] = 300 + 100 * uint32_t(i);
    surface.lengths = limit_edge_lengths(surface, to_buffer(expected), kSlopeQ16, context);
    surface = to_host(surface);
    for (bool lowered = true; lowered;) {
      lowered = false;
      for (uint32_t v = 0; v < expected.size(); ++v)
        for (const uint32_t u : neighbours[v]) {
          const auto way = int64_t(isqrt(uint64_t(distance_sq_q16(surface.position[u], surface.position[v]))));
          const auto most = uint32_t(expected[u] + (way * kSlopeQ16 >> 16));
          if (most < expected[v]) expected[v] = most, lowered = true;
        }
    }
    CHECK(std::equal(expected.begin(), expected.end(), surface.lengths.at.begin()));

    std::vector<uint32_t> mean;
    for (uint32_t v = 0; v < expected.size(); ++v) {
      uint64_t sum = expected[v];
      for (const uint32_t u : neighbours[v]) sum += expected[u];
      const uint64_t count = neighbours[v].size() + 1;
      mean.push_back(uint32_t((sum + count / 2) / count));
    }
    surface.lengths = smooth_edge_lengths(surface, std::move(surface.lengths), 1, context);
    surface = to_host(surface);
    CHECK(std::equal(mean.begin(), mean.end(), surface.lengths.at.begin()));
  }
}

TEST_CASE("open surface: stages that need a closed one refuse it", "[open_surface][stage]") {
  TestContext context;
  const SurfaceMesh surface = surface_of(patch_with_holes(20, 20), context);
  SeedSet seeds = place_seeds(surface, {40, 0}, context);
  DualMesh mesh;
  DualReport report;
  check_refused([&] { six_volume_vox(surface, context); });
  check_refused([&] { triangulate_dual(surface, seeds, {}, report, context); });
  check_refused([&] { subdivide_seeds(surface, mesh, seeds, 80, context); });
  check_refused([&] { collapse_edges(surface, 20, seeds, mesh, context); });
  check_refused([&] { optimize_mesh(surface, {}, seeds, mesh, context); });
}

TEST_CASE("open mesh: collapsing and optimising refuse it on a closed surface, too", "[open_surface][stage][cuda]") {
  TestContext context;
  const Sheet sheet = torus_sheet();
  SeedSet seeds = place_seeds(sheet, {300, 0}, context);
  DualReport report;
  DualMesh mesh = triangulate_dual(sheet, seeds, {}, report, context);
  REQUIRE(report.failed_cells == 0);
  const std::vector<TriangleIndices> fewer(mesh.triangles.begin() + 1, mesh.triangles.end());
  mesh.triangles = to_buffer(fewer);
  const auto open = [&] { return SeededMesh{to_host(mesh), to_host(seeds)}; };
  check_refused([&] { collapse_edges(sheet, open(), {100}, context); });
  check_refused([&] { optimize_mesh(sheet, open(), {}, context); });
}

TEST_CASE("blocks: labels and cells do not depend on how vertices are cut into them", "[blocks][stage]") {
  TestContext context;
  std::vector<NamedMesh> meshes = open_meshes();
  meshes.push_back(sphere_mesh(false, 60, 90, 5000));
  for (const NamedMesh& from : meshes) {
    INFO(from.name);
    SurfaceMesh surface = surface_of(from, context);
    check_blocks(surface);
    const SeedSet seeds = place_seeds(surface, {90, 2}, context);
    const std::vector<uint32_t> labels = labels_by<PlainExecutor>(surface, seeds);
    const std::vector<int64_t> cells = cells_by<PlainExecutor>(surface, seeds);
    for (const int most : {1, 7, 40}) {
      cut_into_blocks(surface, most);
      for (PointQ8& c : surface.blocks.centre) c = {c.x + 100 * most, c.y - 7, c.z + 31};
      check_blocks(surface);
      CHECK(labels_by<PlainExecutor>(surface, seeds) == labels);
      CHECK(labels_by<CpuExecutor>(surface, seeds) == labels);
      CHECK(cells_by<PlainExecutor>(surface, seeds) == cells);
      CHECK(cells_by<CpuExecutor>(surface, seeds) == cells);
    }
  }
}

TEST_CASE("blocks: stages that go through them refuse a surface without, or with too few", "[blocks][stage]") {
  TestContext context;
  SurfaceMesh surface = surface_of(sphere_mesh(false, 60, 90, 5000), context);
  const SeedSet placed = place_seeds(surface, {40, 0}, context);
  DualMesh mesh;
  DualReport report;
  for (const int64_t blocks : {0, 1}) {
    SeedSet seeds = to_host(placed);
    surface.blocks = {Buffer<int64_t>(blocks + 1), Buffer<PointQ8>(blocks)};
    CHECK_THROWS_AS(relax_on_sheet(surface, seeds, {1, 0, 0}, context), Error);
    CHECK_THROWS_AS(triangulate_dual(surface, seeds, {}, report, context), Error);
    CHECK_THROWS_AS(optimize_mesh(surface, {}, seeds, mesh, context), Error);
    CHECK_THROWS_AS(limit_edge_lengths(surface, Buffer<uint32_t>(surface.vertex_count()), 0, context), Error);
  }
}

TEST_CASE("blocks: stages name the offset of a block that is too large, empty or not of all vertices",
          "[blocks][stage]") {
  TestContext context;
  SurfaceMesh surface = surface_of(sphere_mesh(false, 60, 90, 5000), context);
  const Buffer<int64_t> first = surface.blocks.first.to_host();
  const int64_t last = surface.blocks.count(), vertices = surface.vertex_count();
  const SeedSet placed = place_seeds(surface, {40, 0}, context);
  DualMesh mesh;
  DualReport report;
  const auto check_named = [&](const std::string& name, auto call) {
    CHECK(contains(message_of(ErrorCode::usage, call), name));
  };
  const std::vector<std::pair<int64_t, int64_t>> wrong = {
      {0, 1}, {1, 0}, {1, -1}, {1, VertexBlocks::kMostVertices + 1}, {last, vertices + 1}, {last, vertices - 1}};
  for (const auto& [place, value] : wrong) {
    INFO(place << " " << value);
    SeedSet seeds = to_host(placed);
    surface.blocks.first = first.to_host();
    surface.blocks.first[place] = value;
    const std::string name = "blocks.first[" + std::to_string(place) + "] is " + std::to_string(value);
    check_named(name, [&] { relax_on_sheet(surface, seeds, {1, 0, 0}, context); });
    check_named(name, [&] { triangulate_dual(surface, seeds, {}, report, context); });
    check_named(name, [&] { optimize_mesh(surface, {}, seeds, mesh, context); });
    check_named(name, [&] { limit_edge_lengths(surface, Buffer<uint32_t>(vertices), 0, context); });
  }
}

TEST_CASE("blocks: those of a sheet, and of a coarse proxy, are its leaves", "[blocks][sheet][stage][cuda]") {
  TestContext context;
  for (const TriangleSoup& soup : {shapes::torus(2, 0.7, 80, 35), shapes::sphere({0, 0, 0}, 1, 32)}) {
    const auto [lo, hi] = bounding_box(soup);
    const LatticeSurface surface = snap_surface(soup, LatticeFrame::around(lo, hi, 60), context);
    const SiteSet sites = voxelize(surface, context);
    for (const bool proxy : {false, true}) {
      const Sheet sheet = proxy ? build_proxy(sites, surface.frame, {}, context)
                                : build_sheet(surface, sites, sample_sites(surface, sites, context), {}, context);
      check_blocks(sheet);
      CHECK(sheet.is_closed());
      SurfaceMesh expected;
      cut_into_blocks(sheet.corners, expected);
      CHECK(std::equal(expected.extent_vox, expected.extent_vox + 3, sheet.extent_vox));
      CHECK(std::equal(expected.blocks.first.begin(), expected.blocks.first.end(), sheet.blocks.first.begin()));
      CHECK(std::equal(expected.blocks.centre.begin(), expected.blocks.centre.end(), sheet.blocks.centre.begin()));
    }
  }
}
