// The CPU's own ways of labelling a sheet and of summing its cells, against brute force and against the definition.
#include "cpu/relax/pass_simd.h"
#include "cpu/relax/three_cell_simd.h"
#include "isoshell/advanced/stages.h"
#include "support/catch.h"
#include "support/relax_sheets.h"
#include "support/shapes.h"
#include "support/test_context.h"
#include "voxel/random.h"

using namespace isoshell;

namespace {

SeedSet seeds_on(const Sheet& sheet, int64_t count) {
  TestContext context;
  return place_seeds(sheet, {count, 3}, context);
}

/// A seed at every second vertex: more than lists of candidates and tables of local sums have places for.
SeedSet crowded_seeds(const Sheet& sheet) {
  const int64_t count = sheet.vertex_count() / 2;
  SeedSet seeds{Buffer<PointQ8>(count), Buffer<Normal8>(count), Buffer<uint32_t>(count), {}};
  for (int64_t s = 0; s < count; ++s) {
    seeds.home[s] = uint32_t(2 * s);
    seeds.position[s] = sheet.position[2 * s];
    seeds.normal[s] = sheet.normal[2 * s];
  }
  return seeds;
}

/// Labels of seeds that make a few passes, each found with what the pass before left.
void check_labels(const Sheet& sheet, SeedSet seeds) {
  CAPTURE(seeds.size());
  TestContext context;
  CpuExecutor exec(context, "test");
  const SeedSpacing spacing = seed_spacing(exec, sheet, seeds.size());
  LabelSimd lanes(exec, sheet, spacing);
  Buffer<uint32_t> labels(sheet.vertex_count());
  for (int pass = 0; pass < 3; ++pass) {
    lanes.label(exec, seeds, labels.view());
    CHECK(std::vector<uint32_t>(labels.begin(), labels.end()) == brute_force_labels(sheet, seeds, spacing));
    relax_on_sheet(sheet, seeds, {2, 0, 0}, context);
  }
}

/// What a pass measures: the cells, and the energy of every block.
template <class Exec>
std::vector<int64_t> measured(const Sheet& sheet, const SeedSet& seeds, TestContext& context) {
  Exec exec(context, "test");
  typename Exec::Kernels::PassWork work(exec, sheet, seed_spacing(exec, sheet, seeds.size()));
  Buffer<relax_sheet::CellSum> cells(seeds.size());
  Buffer<SplitSum> energy(sheet.blocks.count());
  Buffer<PassState> state(1);
  exec.fill(cells.view(), relax_sheet::CellSum{0, 0, 0, 0});
  exec.for_each("start", 1, relax_sheet::StartPasses{state.view()});
  work.measure(exec, seeds, cells.view(), energy.view(), state.view());
  std::vector<int64_t> out;
  for (const auto& c : cells) out.insert(out.end(), {c.mass, c.first_x, c.first_y, c.first_z});
  for (const auto& e : energy) out.insert(out.end(), {e.high, e.low});
  return out;
}

void check_cells(const Sheet& sheet, const SeedSet& seeds) {
  CAPTURE(seeds.size());
  TestContext context;
  CHECK(measured<CpuExecutor>(sheet, seeds, context) == measured<PlainExecutor>(sheet, seeds, context));
}

}  // namespace

TEST_CASE("labels: lanes find what brute force finds, pass after pass", "[labels][stage]") {
  const Sheet even = torus_sheet(), varied = with_lengths(torus_sheet(), 4), plate = plate_sheet();
  for (const Sheet* sheet : {&even, &varied, &plate}) check_labels(*sheet, seeds_on(*sheet, 300));
}

TEST_CASE("labels: lanes find what brute force finds where seeds are far or crowded", "[labels][stage]") {
  const Sheet torus = torus_sheet(), plate = plate_sheet();
  check_labels(torus, seeds_on(torus, 4));
  check_labels(plate, crowded_seeds(plate));
  for (const int64_t count : {10, 20, 60}) check_labels(plate, seeds_on(plate, count));
}

TEST_CASE("labels: lanes find what brute force finds where many walls lie close together", "[labels][stage]") {
  TriangleSoup stack;
  for (int k = 0; k < 8; ++k) stack = shapes::together(stack, shapes::box({-1, -1, .07 * k}, {1, 1, .07 * k + .035}));
  TestContext context;
  const LatticeFrame frame = LatticeFrame::around({-1, -1, 0}, {1, 1, .525}, 100);
  const LatticeSurface surface = snap_surface(stack, frame, context);
  const SiteSet sites = voxelize(surface, context);
  const Sheet sheet = build_sheet(surface, sites, sample_sites(surface, sites, context), {}, context);
  for (const int64_t count : {100, 1000, 4000}) check_labels(sheet, seeds_on(sheet, count));
}

TEST_CASE("cells: triangles between three cells are split in lanes as by their definition", "[cells][stage]") {
  uint64_t drawn = 0;
  const auto draw = [&](int32_t reach) { return int32_t(random_bits(5, drawn++) % uint64_t(2 * reach + 1)) - reach; };
  for (int round = 0; round < 2000; ++round) {
    const int32_t near = round % 3 == 0 ? 200 : 4000;  // small triangles are cut by one bisector more often
    const int32_t far = round % 7 == 0 ? 20000 : 600;  // beyond 32 bits, too
    ThreeCellSimd lanes;
    SplitTriangle by_definition[ThreeCellSimd::kLanes];
    lanes.count = 1 + round % ThreeCellSimd::kLanes;
    for (int i = 0; i < lanes.count; ++i) {
      SplitTriangle& t = by_definition[i];
      t.area2 = 1 + int64_t(random_bits(6, drawn++) % 1000000);
      lanes.area2[i] = uint32_t(t.area2);
      for (int k = 0; k < 3; ++k) {
        t.p[k] = {draw(near), draw(near), draw(near)};
        t.s[k] = {t.p[k].x + draw(far), t.p[k].y + draw(far), t.p[k].z + draw(far)};
        lanes.corner[k].set(i, t.p[k]);
        lanes.seed[k].set(i, t.s[k]);
        lanes.cell[k][i] = uint32_t(k);
        lanes.has_all[k][i] = k == i % 3 ? 1 : 0;
      }
    }
    lanes.split();
    for (int i = 0; i < lanes.count; ++i) {
      PieceSum pieces[3]{};
      by_definition[i].three_cells([&](int k, const PieceSum& piece) { pieces[k] = piece; });
      pieces[i % 3] = pieces[i % 3] - by_definition[i].total();
      for (int k = 0; k < 3; ++k) {
        const PieceSum off = lanes.gained(k, i) - pieces[lanes.cell[k][i]];
        CHECK((off.mass == 0 && off.first_x == 0 && off.first_y == 0 && off.first_z == 0 && off.second == 0));
      }
    }
  }
}

TEST_CASE("cells: lanes measure what the definition says", "[cells][stage]") {
  const Sheet even = torus_sheet(), varied = with_lengths(torus_sheet(), 4), plate = plate_sheet();
  for (const Sheet* sheet : {&even, &varied, &plate}) check_cells(*sheet, seeds_on(*sheet, 300));
}

TEST_CASE("cells: lanes measure what the definition says where seeds are far or crowded", "[cells][stage]") {
  const Sheet torus = torus_sheet();
  check_cells(torus, seeds_on(torus, 4));
  check_cells(torus, crowded_seeds(torus));
}
