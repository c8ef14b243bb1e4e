// Kernel sets: bodies run the kernels of the set that their executor names, and every set gives what the plain one
// gives. What the stages run is CpuKernels, or with --cuda CudaKernels.
#include <type_traits>

#include "cpu/relax/label_simd.h"
#include "isoshell/advanced/stages.h"
#include "parity/product_hash.h"
#include "stages/dual/dual_body.h"
#include "stages/optimize/optimize_body.h"
#include "stages/relax/relax_sheet_body.h"
#include "stages/sheet/sheet_body.h"
#include "stages/shell/shell_body.h"
#include "stages/sites/samples_body.h"
#include "support/catch.h"
#include "support/fixed_cases.h"
#include "support/relax_sheets.h"
#include "support/site_shapes.h"
#include "support/solid_soup.h"
#include "support/test_context.h"

using namespace isoshell;
using parity::hash_arrays;

namespace {

/// The plain kernels, and how often one of them ran.
struct CountingKernels : PlainKernels {
  static inline int calls = 0;
  struct LabelSheet {
    template <class... Arguments>
    static void run(Arguments&&... arguments) {
      ++calls;
      PlainKernels::LabelSheet::run(arguments...);
    }
  };
};
using CountingExecutor = TbbExecutorWith<CountingKernels>;

template <class Exec>
std::vector<uint32_t> labels_of_partition(const Sheet& sheet, const SeedSet& seeds, TestContext& context) {
  Exec exec(context, "dual");
  SeedSet here = to_host(seeds);
  DualReport report;
  dual::Partition<Exec> cells(exec, sheet, here, {}, report);
  return {cells.label().begin(), cells.label().end()};
}

struct Lattice {
  LatticeSurface surface;
  SiteSet sites;
  SiteSamples samples;
};
Lattice lattice_of(const TriangleSoup& soup, int32_t resolution, TestContext& context) {
  const auto [lo, hi] = bounding_box(soup);
  Lattice l;
  l.surface = snap_surface(soup, LatticeFrame::around(lo, hi, resolution), context);
  l.sites = voxelize(l.surface, context);
  l.samples = sample_sites(l.surface, l.sites, context);
  return l;
}

/// Puts free seeds of a patch, up to 120, at the place of the first one: more than lists and buckets have room for.
void crowd(const SurfaceMesh& surface, SeedSet& seeds) {
  const int64_t first = seeds.fixed.count, end = std::min(seeds.size(), first + 120);
  for (int64_t s = first; s < end; ++s) {
    if (!surface.patch.empty() && surface.patch[seeds.home[s]] != surface.patch[seeds.home[first]]) continue;
    seeds.position[s] = seeds.position[first];
    seeds.normal[s] = seeds.normal[first];
    seeds.home[s] = seeds.home[first];
  }
}

/// A box whose sides are a block each, of triangles so large that a device has no patches of its own for them.
FixedCase box_of_large_triangles(TestContext& context) {
  constexpr int32_t kStep = 2300;
  SurfaceMesh surface = surface_of(cut_box({7, 7, 7}, kStep), context);
  std::vector<int64_t> first{0};
  std::vector<PointQ8> centre;
  for (int32_t side = 0; side < 6; ++side) {
    first.push_back(first.back() + 64);
    int32_t at[3] = {10000 + 7 * kStep / 2, 10000 + 7 * kStep / 2, 10000 + 7 * kStep / 2};
    at[side / 2] = 10000 + side % 2 * 7 * kStep;
    centre.push_back({at[0], at[1], at[2]});
  }
  surface.blocks = {to_buffer(first), to_buffer(centre)};
  SeedSet seeds = with_free_seeds(surface, fixed_on_borders(surface, every_steps(2, kStep)), 30);
  return {"box of large triangles", std::move(surface), std::move(seeds)};
}

std::vector<shapes::NamedSoup> named_soups() {
  return {{"torus", shapes::torus(2, 0.7, 80, 35)},
          {"sieve", shapes::sieve(3, 4, 3, 3)},
          {"two spheres", shapes::together(shapes::sphere({0, 0, 0}, 1, 32), shapes::sphere({0, 0, 3}, 0.4, 16))},
          {"random soup", shapes::random_soup(150, 4, 3, 1)}};
}

}  // namespace

// The kernels were once chosen by what a source file included: the same partition labelled in lanes in one of them and
// plainly in another, in one executable.
static_assert(!std::is_same_v<dual::Partition<CpuExecutor>, dual::Partition<PlainExecutor>>);

TEST_CASE("kernels: bodies of different sets live side by side, each with its own kernels", "[kernels]") {
  TestContext context;
  const Sheet sheet = plate_sheet();
  const SeedSet seeds = place_seeds(sheet, {200, 3}, context);
  CountingKernels::calls = 0;
  const std::vector<uint32_t> counted = labels_of_partition<CountingExecutor>(sheet, seeds, context);
  CHECK(CountingKernels::calls == 1);
  CHECK(labels_of_partition<CpuExecutor>(sheet, seeds, context) == counted);
  CHECK(labels_of_partition<PlainExecutor>(sheet, seeds, context) == counted);
  CHECK(CountingKernels::calls == 1);
}

TEST_CASE("kernels: samples and shells are those of the plain set", "[kernels][parity][cuda]") {
  TestContext context;
  PlainExecutor exec(context, "test");
  for (const shapes::NamedSoup& shape : named_soups()) {
    INFO(shape.name);
    const Lattice l = lattice_of(shape.soup, 60, context);
    CHECK(hash_arrays(l.samples) == hash_arrays(sample_sites_body(exec, l.surface, l.sites)));
    for (const int32_t band_vox : {1, 3, 9})
      CHECK(hash_arrays(build_shell(l.sites, {band_vox}, context)) ==
            hash_arrays(build_shell_body(exec, l.sites, {band_vox})));
  }
}

TEST_CASE("kernels: sheets are those of the plain set", "[kernels][parity][cuda]") {
  TestContext context;
  PlainExecutor exec(context, "test");
  for (const shapes::NamedSoup& shape : named_soups())
    for (const SheetOptions& options : {SheetOptions{0, 0}, SheetOptions{2, 0}, SheetOptions{0, 300 << 16}}) {
      INFO(shape.name << ", closing " << options.closing_vox);
      const Lattice l = lattice_of(shape.soup, 60, context);
      const Sheet plain = build_sheet_body(exec, l.surface, l.sites, l.sites, l.samples, nullptr, options);
      CHECK(hash_arrays(build_sheet(l.surface, l.sites, l.samples, options, context)) == hash_arrays(plain));
    }
}

TEST_CASE("kernels: relaxed seeds, duals and improved meshes are those of the plain set", "[kernels][parity][cuda]") {
  TestContext context;
  PlainExecutor exec(context, "test");
  const Sheet even = torus_sheet(), varied = with_lengths(torus_sheet(), 4), plate = plate_sheet();
  int64_t split = 0, flips = 0;
  for (const Sheet* sheet : {&even, &varied, &plate})
    for (const int64_t count : {8, 700}) {  // few seeds make cells that must be split
      INFO(count << " seeds on a sheet of " << sheet->vertex_count() << " vertices");
      SeedSet seeds = place_seeds(*sheet, {count, 3}, context), plain_seeds = to_host(seeds);
      const RelaxReport report = relax_on_sheet(*sheet, seeds, {8, 0, 0}, context);
      CHECK(report.energy == relax_on_sheet_body(exec, *sheet, plain_seeds, {8, 0, 0}).energy);
      CHECK(hash_arrays(seeds) == hash_arrays(plain_seeds));

      DualOptions keep_cells;
      keep_cells.keep_cells = true;
      Triangulation dual = isoshell::triangulate_dual(*sheet, std::move(seeds), keep_cells, context);
      Triangulation plain = triangulate_dual_body(exec, *sheet, std::move(plain_seeds), keep_cells);
      REQUIRE(dual.report.failed_cells == 0);
      CHECK(dual.report.repair_rounds == plain.report.repair_rounds);
      CHECK(hash_arrays(dual.mesh) == hash_arrays(plain.mesh));
      const Buffer<uint32_t> cell = dual.cell.to_host();
      CHECK(std::equal(cell.begin(), cell.end(), plain.cell.begin(), plain.cell.end()));
      split += dual.report.inserted_seeds;
      DualMesh &mesh = dual.mesh, &plain_mesh = plain.mesh;
      seeds = std::move(dual.seeds);
      plain_seeds = std::move(plain.seeds);

      flips += optimize_mesh(*sheet, {}, seeds, mesh, context).flips;
      optimize_mesh_body(exec, *sheet, {}, plain_seeds, plain_mesh);
      CHECK(hash_arrays(mesh) == hash_arrays(plain_mesh));
      CHECK(hash_arrays(seeds) == hash_arrays(plain_seeds));
    }
  CHECK(split > 0);
  CHECK(flips > 0);
}

TEST_CASE("kernels: seeds of patches, some of them fixed, are those of the plain set", "[kernels][parity][cuda]") {
  TestContext context;
  PlainExecutor exec(context, "test");
  std::vector<FixedCase> cases = fixed_cases(context);
  cases.push_back(box_of_large_triangles(context));
  for (FixedCase& c : cases)
    for (const bool crowded : {false, true}) {
      INFO(c.name << (crowded ? ", crowded" : ""));
      SeedSet seeds = host_copy(c.seeds);
      if (crowded) crowd(c.surface, seeds);
      SeedSet plain_seeds = host_copy(seeds);
      const RelaxReport report = relax_on_sheet(c.surface, seeds, {12, 0, 0}, context);
      CHECK(report.energy == relax_on_sheet_body(exec, c.surface, plain_seeds, {12, 0, 0}).energy);
      CHECK(hash_arrays(seeds) == hash_arrays(plain_seeds));
    }
}
