// Labels and relaxation on surfaces that are cut into patches, with seeds that are fixed on their borders, against
// brute force.
#include <cstring>

#include "core/copy_product.h"
#include "isoshell/error.h"
#include "support/catch.h"
#include "support/fixed_cases.h"
#include "support/pass_results.h"
#include "support/refusals.h"
#include "support/test_context.h"

using namespace isoshell;

namespace {

uint32_t patch_of(const SurfaceMesh& surface, int64_t vertex) {
  return surface.patch.empty() ? 0 : surface.patch[vertex];
}

/// The label that is prescribed, or the nearest of all seeds that are in the vertex's patch.
uint32_t expected_label(const FixedCase& c, int64_t vertex, int64_t penalty_q16) {
  if (c.seeds.fixed.count > 0 && c.seeds.fixed.of_vertex[vertex] != kNone) return c.seeds.fixed.of_vertex[vertex];
  int64_t best = INT64_MAX;
  uint32_t id = kNone;
  for (int64_t s = 0; s < c.seeds.size(); ++s) {
    if (patch_of(c.surface, c.seeds.home[s]) != patch_of(c.surface, vertex)) continue;
    const bool opposite = 4 * dot(c.surface.normal[vertex], c.seeds.normal[s]) < -127 * 127;
    const int64_t cost =
        distance_sq_q16(c.surface.position[vertex], c.seeds.position[s]) + (opposite ? penalty_q16 : 0);
    if (cost < best) best = cost, id = uint32_t(s);
  }
  return id;
}
std::vector<uint32_t> expected_labels(const FixedCase& c) {
  Context context;
  PlainExecutor exec(context, "test");
  const int64_t penalty_q16 = seed_spacing(exec, c.surface, c.seeds.size()).penalty_q16;
  std::vector<uint32_t> labels;
  for (int64_t v = 0; v < c.surface.vertex_count(); ++v) labels.push_back(expected_label(c, v, penalty_q16));
  return labels;
}

/// With so few places for candidates that most blocks take the path without lists.
std::vector<uint32_t> labels_without_lists(const SurfaceMesh& surface, const SeedSet& seeds) {
  Context context;
  PlainExecutor exec(context, "test");
  const SeedSpacing spacing = seed_spacing(exec, surface, seeds.size());
  const PointGrid grid = grid_of_seeds(exec, surface, seeds, spacing);
  const Buffer<uint32_t> patch_of_seed = find_patches_of_seeds(exec, surface, seeds);
  Buffer<uint32_t> labels(surface.vertex_count());
  exec.for_each("label", surface.blocks.count(),
                label::LabelBlock<1>{surface.blocks.view(),
                                     surface.position.view(),
                                     surface.normal.view(),
                                     grid.view(),
                                     seeds.normal.view(),
                                     spacing,
                                     labels.view(),
                                     {surface.patch.view(), patch_of_seed.view()}});
  prescribe_labels(exec, seeds.fixed, labels.view());
  return {labels.begin(), labels.end()};
}

/// Whether the first elements of two arrays of one size are the same bytes.
template <class T>
bool same(const Buffer<T>& a, const Buffer<T>& b, int64_t count) {
  return a.size() == b.size() && (count == 0 || std::memcmp(a.data(), b.data(), size_t(count) * sizeof(T)) == 0);
}

template <class Call>
void check_refused(const std::string& word, Call call) {
  CHECK(contains(message_of(ErrorCode::usage, call), word));
}

}  // namespace

TEST_CASE("fixed seeds: labels are prescribed on borders, and elsewhere the nearest of the patch by brute force",
          "[fixed_seeds][stage]") {
  TestContext context;
  for (const FixedCase& c : fixed_cases(context)) {
    INFO(c.name);
    const std::vector<uint32_t> expected = expected_labels(c);
    CHECK(labels_by<PlainExecutor>(c.surface, c.seeds) == expected);
    CHECK(labels_by<CpuExecutor>(c.surface, c.seeds) == expected);
    CHECK(labels_without_lists(c.surface, c.seeds) == expected);
  }
}

TEST_CASE("fixed seeds: cells of a pass add up to the area, the same on every kernel set", "[fixed_seeds][stage]") {
  TestContext context;
  for (const FixedCase& c : fixed_cases(context)) {
    INFO(c.name);
    const std::vector<int64_t> cells = cells_by<PlainExecutor>(c.surface, c.seeds);
    CHECK(cells_by<CpuExecutor>(c.surface, c.seeds) == cells);
    int64_t total = 0;
    for (size_t i = 0; i < size_t(4 * c.seeds.size()); i += 4) total += cells[i];
    CHECK(std::abs(total - doubled_area(c.surface)) < 8 * c.surface.triangles.size());
  }
}

TEST_CASE("fixed seeds: labels found with what the pass before left are those of brute force", "[fixed_seeds][stage]") {
  TestContext context;
  for (FixedCase& c : fixed_cases(context)) {
    INFO(c.name);
    CpuExecutor exec(context, "test");
    LabelSimd lanes(exec, c.surface, seed_spacing(exec, c.surface, c.seeds.size()));
    Buffer<uint32_t> labels(c.surface.vertex_count());
    for (int pass = 0; pass < 3; ++pass) {
      lanes.label(exec, c.seeds, labels.view());
      CHECK(std::vector<uint32_t>(labels.begin(), labels.end()) == expected_labels(c));
      relax_on_sheet(c.surface, c.seeds, {2, 0, 0}, context);
    }
  }
}

TEST_CASE("fixed seeds: relaxation moves the free ones in their patches, and the energy falls",
          "[fixed_seeds][relax][stage][cuda]") {
  TestContext context;
  for (FixedCase& c : fixed_cases(context)) {
    INFO(c.name);
    const int64_t fixed = c.seeds.fixed.count;
    // A seed on a crease may have the normal of the crease; it keeps it.
    for (int64_t s = 0; s < fixed; s += 3) c.seeds.normal[s] = {3, int8_t(s % 20), -20};
    const SeedSet start = host_copy(c.seeds);
    const RelaxReport report = relax_on_sheet(c.surface, c.seeds, {30, 0, 0}, context);
    REQUIRE(c.seeds.size() == start.size());
    CHECK(report.passes == 30);
    if (start.size() == fixed)
      CHECK(report.energy.back() == report.energy.front());
    else
      CHECK(report.energy.back() < report.energy.front());
    CHECK(same(c.seeds.position, start.position, fixed));
    CHECK(same(c.seeds.normal, start.normal, fixed));
    CHECK(same(c.seeds.home, start.home, fixed));
    CHECK(c.seeds.fixed.count == fixed);
    CHECK(same(c.seeds.fixed.of_vertex, start.fixed.of_vertex, start.fixed.of_vertex.size()));
    CHECK(same(c.seeds.fixed.joined, start.fixed.joined, start.fixed.joined.size()));
    int64_t moved = 0;
    for (int64_t s = fixed; s < start.size(); ++s) {
      CHECK(patch_of(c.surface, c.seeds.home[s]) == patch_of(c.surface, start.home[s]));
      moved += distance_sq_q16(c.seeds.position[s], start.position[s]) > 0;
    }
    CHECK(2 * moved >= start.size() - fixed);
  }
}

TEST_CASE("fixed seeds: one seed a patch goes to the middle of it", "[fixed_seeds][relax][stage][cuda]") {
  TestContext context;
  constexpr int32_t kStep = 150, kHalf[3] = {12 * kStep, 10 * kStep, 8 * kStep};
  const SurfaceMesh surface = surface_of(cut_box({24, 20, 16}, kStep), context);
  SeedSet seeds = one_seed_a_patch(surface);
  REQUIRE(seeds.size() == 6);
  relax_on_sheet(surface, seeds, {200, 0, 0}, context);
  for (int64_t s = 0; s < 6; ++s) {
    const PointQ8 p = seeds.position[s];
    const int32_t at[3] = {p.x, p.y, p.z}, axis = int32_t(s / 2), side = int32_t(s % 2);
    for (int32_t a = 0; a < 3; ++a)
      CHECK(std::abs(at[a] - 10000 - (a == axis ? 2 * side * kHalf[a] : kHalf[a])) < kStep / 4);
  }
}

TEST_CASE("fixed seeds: labels do not depend on how patches are cut into blocks", "[fixed_seeds][blocks][stage]") {
  TestContext context;
  for (FixedCase& c : fixed_cases(context)) {
    INFO(c.name);
    const std::vector<uint32_t> labels = labels_by<PlainExecutor>(c.surface, c.seeds);
    const std::vector<int64_t> cells = cells_by<PlainExecutor>(c.surface, c.seeds);
    for (const int most : {1, 7}) {
      cut_into_blocks(c.surface, most);
      CHECK(labels_by<PlainExecutor>(c.surface, c.seeds) == labels);
      CHECK(labels_by<CpuExecutor>(c.surface, c.seeds) == labels);
      CHECK(cells_by<CpuExecutor>(c.surface, c.seeds) == cells);
    }
  }
}

TEST_CASE("fixed seeds: a patch without a seed is refused, and so are seeds of another surface",
          "[fixed_seeds][relax][stage][cuda]") {
  TestContext context;
  SurfaceMesh surface = surface_of(cut_box({12, 10, 8}, 150), context);
  SeedSet lonely = one_seed_a_patch(surface);
  lonely.home[4] = lonely.home[5];
  const auto refused = [&](const std::string& word, const SeedSet& from) {
    SeedSet seeds = host_copy(from);
    check_refused(word, [&] { relax_on_sheet(surface, seeds, {1, 0, 0}, context); });
  };
  refused("patch 4 has 0 of the 6 seeds", lonely);

  const SeedSet whole = with_free_seeds(surface, fixed_on_borders(surface, every_steps(2, 150)), 30);
  for (const int64_t count : {int64_t(-1), whole.size() + 1}) {
    SeedSet seeds = host_copy(whole);
    seeds.fixed.count = count;
    refused("fixed.count is " + std::to_string(count), seeds);
  }
  SeedSet seeds = host_copy(whole);
  seeds.fixed.joined = Buffer<uint32_t>(1);
  refused("fixed.joined.size() is 1", seeds);
  seeds = host_copy(whole);
  seeds.fixed.of_vertex = Buffer<uint32_t>(1);
  refused("fixed.of_vertex.size() is 1", seeds);
  seeds = host_copy(whole);
  check_refused("fixed", [&] { attach_to_sheet(surface, seeds, context); });
}
