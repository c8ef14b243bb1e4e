// Seeds on the sheet, their labels, and relaxation.
#include <algorithm>
#include <cmath>

#include "cpu/executor_tbb.h"
#include "isoshell/advanced/digest.h"
#include "isoshell/advanced/stages.h"
#include "isoshell/error.h"
#include "stages/labels/label_body.h"
#include "stages/relax/relax_sheet_body.h"
#include "support/catch.h"
#include "support/pass_results.h"
#include "support/relax_sheets.h"
#include "support/shapes.h"
#include "support/test_context.h"

using namespace isoshell;

namespace {

template <int kCapacity>
std::vector<uint32_t> labels_with_capacity(const Sheet& sheet, const SeedSet& seeds, const SeedSpacing& spacing,
                                           TestContext& context) {
  PlainExecutor exec(context, "test");
  const PointGrid grid = grid_of_seeds(exec, sheet, seeds, spacing);
  std::vector<uint32_t> labels(size_t(sheet.vertex_count()));
  exec.for_each("label", sheet.blocks.count(),
                label::LabelBlock<kCapacity>{sheet.blocks.view(),
                                             sheet.position.view(),
                                             sheet.normal.view(),
                                             grid.view(),
                                             seeds.normal.view(),
                                             spacing,
                                             {labels.data(), int64_t(labels.size())}});
  return labels;
}

/// Two wide, along x, with four vertices at each of so many steps.
TriangleSoup square_tube(uint32_t steps) {
  TriangleSoup soup;
  for (uint32_t x = 0; x <= steps; ++x)
    for (const auto& [y, z] : std::vector<std::pair<double, double>>{{0, 0}, {2, 0}, {2, 2}, {0, 2}})
      soup.vertices.push_back({double(x), y, z});
  const auto quad = [&](uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    soup.triangles.push_back({a, b, c});
    soup.triangles.push_back({a, c, d});
  };
  quad(3, 2, 1, 0);
  for (uint32_t first = 0; first < 4 * steps; first += 4)
    for (uint32_t i = 0; i < 4; ++i) {
      const uint32_t a = first + i, b = first + (i + 1) % 4;
      quad(a, b, b + 4, a + 4);
    }
  quad(4 * steps, 4 * steps + 1, 4 * steps + 2, 4 * steps + 3);
  return soup;
}

SeedSpacing spacing_of(const Sheet& sheet, const SeedSet& seeds, TestContext& context) {
  PlainExecutor exec(context, "test");
  return seed_spacing(exec, sheet, seeds.size());
}

}  // namespace

TEST_CASE("seeds: every stratum of the sheet's area gets one, near its home", "[seeds][stage]") {
  TestContext context;
  const Sheet sheet = torus_sheet();
  const SeedSet seeds = place_seeds(sheet, {900, 3}, context);
  REQUIRE(seeds.size() == 900);
  for (int64_t s = 0; s < seeds.size(); ++s)
    CHECK(distance_sq_q16(seeds.position[s], sheet.position[seeds.home[s]]) < int64_t(8 * 256) * (8 * 256));
  CHECK(digest(place_seeds(sheet, {900, 3}, context)) == digest(seeds));
  CHECK(digest(place_seeds(sheet, {900, 4}, context)) != digest(seeds));
  CHECK_THROWS_AS(place_seeds(sheet, {3, 0}, context), Error);
  CHECK_THROWS_AS(place_seeds(sheet, {sheet.vertex_count(), 0}, context), Error);
}

TEST_CASE("labels: each sheet vertex has its nearest seed, the penalty counted, at any density", "[relax][stage]") {
  TestContext context;
  for (const bool plate : {false, true})
    for (const uint32_t ratio : {1u, 8u}) {
      Sheet sheet = plate ? plate_sheet() : torus_sheet();
      if (ratio > 1) sheet = with_lengths(std::move(sheet), ratio);
      for (int64_t count : {8, 30, 400, 1600}) {
        const SeedSet seeds = place_seeds(sheet, {count, 1}, context);
        const SeedSpacing spacing = spacing_of(sheet, seeds, context);
        const std::vector<uint32_t> expected = brute_force_labels(sheet, seeds, spacing);
        CHECK(labels_with_capacity<label::kMaxCandidates>(sheet, seeds, spacing, context) == expected);
        // So few places that most leaves overflow and take the path without lists.
        CHECK(labels_with_capacity<3>(sheet, seeds, spacing, context) == expected);
      }
    }
}

TEST_CASE("labels: along a tube that has lost its seeds but at one end, the nearest is found wherever it is",
          "[relax][stage]") {
  TestContext context;
  const Sheet tube = sheet_of_soup(square_tube(8000), 8192, 1, 0);
  const int64_t count = 3500;  // vertices are in the order of x
  SeedSet seeds{Buffer<PointQ8>(count), Buffer<Normal8>(count), Buffer<uint32_t>(count), {}};
  for (int64_t s = 0; s < count; ++s) {
    seeds.position[s] = tube.position[s];
    seeds.normal[s] = tube.normal[s];
    seeds.home[s] = uint32_t(s);
  }
  const std::vector<uint32_t> expected = brute_force_labels(tube, seeds, spacing_of(tube, seeds, context));
  CHECK(labels_by<CpuExecutor>(tube, seeds) == expected);
  CHECK(labels_by<PlainExecutor>(tube, seeds) == expected);
}

TEST_CASE("lengths: mass and share of a triangle follow the powers, at every area and ratio", "[lengths]") {
  const uint32_t length[] = {300, 300, 300, 2400, 2400, 2400, 4800};
  const EdgeLengthsView view{{length, 7}, 300, 4800};
  const EdgeLengthsView even{};
  for (const uint32_t area2 : {1u, 1000u, 65536u, 131072u, 1u << 29}) {
    CHECK(even.mass(area2, {0, 1, 2}) == area2);
    CHECK(even.share_of_seeds(area2, {0, 1, 2}) == int64_t(area2));
    CHECK(view.mass(area2, {0, 1, 2}) == 4 * area2);
    CHECK(view.share_of_seeds(area2, {0, 1, 2}) == int64_t(area2));
    CHECK(std::abs(double(view.mass(area2, {3, 4, 5})) - area2 / 1024.0) <= 0.6);
    CHECK(std::abs(double(view.share_of_seeds(area2, {3, 4, 5})) - area2 / 64.0) <= 1);
    const double mixed = 300.0 / 1000;  // corners of 300, 300 and 2400
    CHECK(std::abs(double(view.mass(area2, {0, 1, 3})) - 4 * area2 * mixed * mixed * mixed * mixed) <=
          0.6 + area2 * 1e-3);
  }
  CHECK(view.mass(UINT32_MAX, {0, 1, 2}) == UINT32_MAX);  // cut, not wrapped
  CHECK(view.scaled(100, 6) == 1600);
  CHECK(even.scaled(100, 6) == 100);
}

TEST_CASE("lengths: equal ones change nothing in the placing of seeds", "[lengths]") {
  TestContext context;
  const Sheet even = torus_sheet(), same = with_lengths(torus_sheet(), 1);
  CHECK(digest(place_seeds(even, {500, 0}, context)) == digest(place_seeds(same, {500, 0}, context)));
}

TEST_CASE("lengths: relaxed cells have areas by the square of their lengths", "[lengths][relax]") {
  TestContext context;
  PlainExecutor exec(context, "test");
  const Sheet sheet = with_lengths(torus_sheet(), 4);
  SeedSet seeds = place_seeds(sheet, {500, 0}, context);
  relax_on_sheet(sheet, seeds, {60, 0, 0}, context);
  Buffer<uint32_t> label(sheet.vertex_count());
  PlainKernels::LabelSheet::run(exec, sheet, seeds, spacing_of(sheet, seeds, context), label.view());
  std::vector<double> area(size_t(seeds.size()));
  const label::DoubledArea doubled{sheet.position.view(), sheet.triangles.view()};
  for (int64_t t = 0; t < sheet.triangles.size(); ++t) {
    const TriangleIndices i = sheet.triangles[t];
    for (const uint32_t v : {i.a, i.b, i.c}) area[label[v]] += double(doubled(t)) / 3;
  }
  double mean = 0, error = 0;
  std::vector<double> part;
  for (int64_t s = 0; s < seeds.size(); ++s) {
    const double length = sheet.lengths.at[seeds.home[s]];
    part.push_back(area[size_t(s)] / (length * length));
    mean += part.back() / double(seeds.size());
  }
  for (const double p : part) error += std::abs(p / mean - 1) / double(seeds.size());
  CHECK(error < 0.15);
}

TEST_CASE("relax: the energy falls towards that of hexagons", "[relax][stage]") {
  TestContext context;
  const Sheet sheet = torus_sheet();
  SeedSet seeds = place_seeds(sheet, {400, 0}, context);
  const RelaxReport report = relax_on_sheet(sheet, seeds, {60, 0, 0}, context);
  REQUIRE(report.energy.size() == 60);
  CHECK(report.energy.back() < 0.93 * report.energy.front());
  // Second moment over (area^2 / k): 5 / (18 sqrt 3) = 0.1604 for regular hexagons. The report's unit: doubled area,
  // twelve times the moment, shifted down by 8 and 4 bits.
  PlainExecutor exec(context, "test");
  const double area = double(doubled_area_q16(exec, sheet)) / 2;
  const double normalised = report.energy.back() * 256 * 16 / 2 / 12 / (area * area / 400);
  CHECK(normalised > 0.160);
  CHECK(normalised < 0.170);
}

TEST_CASE("relax: full tables of local sums change nothing, and the cells add up to the sheet", "[relax][stage]") {
  TestContext context;
  PlainExecutor exec(context, "test");
  const Sheet sheet = torus_sheet();
  const SeedSet seeds = place_seeds(sheet, {1500, 0}, context);
  const relax_sheet::Patches patches = relax_sheet::make_patches(exec, sheet);
  Buffer<uint32_t> labels(sheet.vertex_count());
  PlainKernels::LabelSheet::run(exec, sheet, seeds, spacing_of(sheet, seeds, context), labels.view());
  const auto sums = [&](auto like) {
    Buffer<relax_sheet::CellSum> cells(seeds.size());
    Buffer<SplitSum> energy(sheet.blocks.count());
    Buffer<PassState> state(1);
    exec.fill(cells.view(), relax_sheet::CellSum{0, 0, 0, 0});
    exec.for_each("start", 1, relax_sheet::StartPasses{state.view()});
    like = {sheet.blocks.centre.view(),
            patches.first.view(),
            patches.triangles.view(),
            sheet.position.view(),
            labels.view(),
            seeds.position.view(),
            cells.view(),
            energy.view(),
            state.view()};
    exec.for_each("sum", sheet.blocks.count(), like);
    std::vector<int64_t> out;
    for (const auto& c : cells) out.insert(out.end(), {c.mass, c.first_x, c.first_y, c.first_z});
    for (const auto& e : energy) out.insert(out.end(), {e.high, e.low});
    return out;
  };
  const std::vector<int64_t> wide = sums(relax_sheet::SumBlock<64>{});
  CHECK(sums(relax_sheet::SumBlock<2>{}) == wide);
  int64_t total = 0;
  for (size_t i = 0; i < size_t(4 * seeds.size()); i += 4) total += wide[i];
  CHECK(std::abs(total - doubled_area_q16(exec, sheet)) < 8 * sheet.triangles.size());
}

TEST_CASE("relax: threads do not change a bit", "[relax][parity]") {
  const Sheet sheet = torus_sheet();
  uint64_t expected = 0;
  for (int threads : {1, 2, 4}) {
    TestContext context;
    context.threads = threads;
    SeedSet seeds = place_seeds(sheet, {600, 0}, context);
    relax_on_sheet(sheet, seeds, {30, 0, 0}, context);
    if (threads == 1) expected = digest(seeds);
    CHECK(digest(seeds) == expected);
  }
}
