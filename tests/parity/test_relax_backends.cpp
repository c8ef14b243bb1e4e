// Relaxation on the device goes other ways than the body: patches, lists of candidates, buckets of seeds. Each has a
// limit and a way round it; here every one of them is pushed past it, and the seeds must stay those of the CPU.
#include <algorithm>

#include "isoshell/advanced/digest.h"
#include "support/catch.h"
#include "support/paper_setup.h"
#include "support/relax_sheets.h"
#include "support/shapes.h"

using namespace isoshell;

namespace {

/// Seeds, energies and passes after a relaxation on one backend.
struct Relaxed {
  uint64_t seeds;
  std::vector<double> energy;
  bool converged;
};
bool operator==(const Relaxed& a, const Relaxed& b) {
  return a.seeds == b.seeds && a.energy == b.energy && a.converged == b.converged;
}

template <class Relax>
Relaxed relaxed(const SeedSet& start, const RelaxOptions& options, Backend backend, Relax relax) {
  Context context;
  context.backend = backend;
  SeedSet seeds = to_host(start);
  const RelaxReport report = relax(seeds, options, context);
  return {digest(to_host(seeds)), report.energy, report.converged};
}

template <class Relax>
void same_after(const std::vector<int32_t>& passes, const SeedSet& start, int32_t tolerance_ppb, Relax relax) {
  for (const int32_t n : passes) {
    CAPTURE(start.size(), n);
    const RelaxOptions options{n, tolerance_ppb, 0};
    CHECK((relaxed(start, options, Backend::cuda, relax) == relaxed(start, options, Backend::cpu, relax)));
  }
}

auto on_sheet(const Sheet& sheet) {
  return [&](SeedSet& seeds, const RelaxOptions& o, Context& c) {
    RelaxedSeeds relaxed = relax_on_sheet(sheet, std::move(seeds), o, c);
    seeds = std::move(relaxed.seeds);
    return relaxed.report;
  };
}
auto in_shell(const PaperSetup& s) {
  return [&](SeedSet& seeds, const RelaxOptions& o, Context& c) {
    RelaxedSeeds relaxed = relax_in_shell(s.shell, s.sites, s.samples, std::move(seeds), o, c);
    seeds = std::move(relaxed.seeds);
    return relaxed.report;
  };
}

SeedSet seeds_on(const Sheet& sheet, int64_t count) {
  Context cpu;
  cpu.backend = Backend::cpu;
  return place_seeds(sheet, {count, 1}, cpu);
}

SeedSet first_of(const SeedSet& seeds, int64_t count) {
  SeedSet out{Buffer<PointQ8>(count), Buffer<Normal8>(count), Buffer<uint32_t>(count), {}};
  for (int64_t i = 0; i < count; ++i) {
    out.position[i] = seeds.position[i];
    out.normal[i] = seeds.normal[i];
    out.home[i] = seeds.home[i];
  }
  return out;
}

void label_both(const Sheet& sheet, const SeedSet& start) {
  uint64_t digests[2];
  for (const Backend backend : {Backend::cpu, Backend::cuda}) {
    Context context;
    context.backend = backend;
    const DualMesh mesh = to_host(triangulate_dual(sheet, to_host(start), {0}, context).mesh);
    digests[backend == Backend::cuda] = digest(to_world(mesh, sheet.frame));
  }
  CHECK(digests[0] == digests[1]);
}

}  // namespace

TEST_CASE("relax on both: seeds of any density, two sides of a wall included", "[relax][cuda]") {
  for (const bool plate : {false, true}) {
    const Sheet sheet = plate ? plate_sheet() : torus_sheet();
    // The most are so dense that no list of candidates holds a patch's.
    for (const int64_t count : {8, 30, 400, 1500}) {
      const SeedSet seeds = seeds_on(sheet, count);
      same_after({1, 2, 20}, seeds, 0, on_sheet(sheet));
      label_both(sheet, seeds);
    }
  }
}

TEST_CASE("relax on both: lengths that vary", "[relax][lengths][cuda]") {
  for (const bool plate : {false, true})
    for (const uint32_t ratio : {3u, 16u}) {
      const Sheet sheet = with_lengths(plate ? plate_sheet() : torus_sheet(), ratio);
      for (const int64_t count : {8, 400, 1500}) {
        const SeedSet seeds = seeds_on(sheet, count);
        same_after({1, 2, 20}, seeds, 0, on_sheet(sheet));
        label_both(sheet, seeds);
      }
    }
}

TEST_CASE("relax on both: a pass more than a batch, and the stop rule within one", "[relax][cuda]") {
  const Sheet sheet = torus_sheet();
  const SeedSet seeds = seeds_on(sheet, 200);
  same_after({0, 15, 16, 17, 33}, seeds, 0, on_sheet(sheet));
  same_after({100}, seeds, 1000000, on_sheet(sheet));
  same_after({100}, seeds, 1000000000, on_sheet(sheet));
}

TEST_CASE("relax on both: all seeds in one bucket", "[relax][cuda]") {
  const Sheet sheet = torus_sheet();
  SeedSet seeds = seeds_on(sheet, 300);
  for (int64_t i = 0; i < 260; ++i) {
    seeds.home[i] = uint32_t(100 + i % 3);
    seeds.position[i] = sheet.position[seeds.home[i]];
    seeds.normal[i] = sheet.normal[seeds.home[i]];
  }
  same_after({1, 2, 20}, seeds, 0, on_sheet(sheet));
}

TEST_CASE("relax on both: few vertices that all seeds around face away from", "[relax][cuda]") {
  Sheet sheet = torus_sheet();
  for (int64_t v = 0; v < sheet.vertex_count(); v += 499) {
    Normal8& n = sheet.normal[v];
    n = {int8_t(-n.x), int8_t(-n.y), int8_t(-n.z)};
  }
  for (const int64_t count : {30, 400, 1500}) {
    const SeedSet seeds = seeds_on(sheet, count);
    same_after({1, 2, 20}, seeds, 0, on_sheet(sheet));
    label_both(sheet, seeds);
  }
}

TEST_CASE("relax on both: seeds far from most of the sheet, and coming closer", "[relax][cuda]") {
  // A pass looks no farther than labels reached in the one before: here most have farther seeds, then nearer ones.
  const Sheet sheet = torus_sheet();
  SeedSet seeds = seeds_on(sheet, 60);
  for (int64_t i = 2; i < seeds.size(); ++i) {
    seeds.home[i] = uint32_t(40 * i);
    seeds.position[i] = sheet.position[seeds.home[i]];
    seeds.normal[i] = sheet.normal[seeds.home[i]];
  }
  same_after({1, 2, 3, 8, 40}, seeds, 0, on_sheet(sheet));
}

TEST_CASE("relax on both: triangles too large for patches", "[relax][cuda]") {
  const Sheet sheet = sheet_of_soup(shapes::torus(2, 0.7, 24, 12), 256, 1, 1);
  same_after({1, 2, 20}, seeds_on(sheet, 40), 0, on_sheet(sheet));
}

TEST_CASE("relax in shell on both: seeds of any density, crowded, all in one bucket, and left alone",
          "[relax_shell][cuda]") {
  Context cpu;
  cpu.backend = Backend::cpu;
  for (const int32_t band : {1, 3}) {
    const PaperSetup setup = paper_setup(ball_skin(20), band);
    for (const int64_t count : {4, 50, 600, 2500})
      same_after({1, 2, 20}, place_seeds(setup.sites, setup.samples, {count, 3}, cpu), 0, in_shell(setup));
    // Whole leaves where seeds are far apart on average, and more of them than a list holds in some: 400 of 2500.
    const SeedSet dense = place_seeds(setup.sites, setup.samples, {2500, 3}, cpu);
    same_after({1, 2, 20}, first_of(dense, 400), 0, in_shell(setup));
    SeedSet seeds = place_seeds(setup.sites, setup.samples, {100, 3}, cpu);
    for (int64_t i = 0; i < 60; ++i) seeds.position[i] = seeds.position[i % 2], seeds.home[i] = seeds.home[i % 2];
    same_after({1, 2, 20}, seeds, 0, in_shell(setup));
    same_after({60}, seeds, 10000000, in_shell(setup));
  }
}

TEST_CASE("relax in shell on both: seeds several leaves away, and beyond the short forms", "[relax_shell][cuda]") {
  Context cpu;
  cpu.backend = Backend::cpu;
  const PaperSetup setup = paper_setup(ball_skin(100), 1);
  for (const int64_t count : {4, 40}) {
    const SeedSet seeds = place_seeds(setup.sites, setup.samples, {count, 3}, cpu);
    same_after({1, 2, 20}, seeds, 0, in_shell(setup));
    same_after({1, 2, 20}, first_of(seeds, 2), 0, in_shell(setup));
  }
}

TEST_CASE("relax in shell on both: hashed buckets that overflow", "[relax_shell][cuda]") {
  Context cpu;
  cpu.backend = Backend::cpu;
  const PaperSetup setup = paper_setup(ball_skin(100), 2);
  // As far apart as in a run of many vertices; then as dense as seeds may be.
  for (const int64_t share : {15, 2}) {
    const int64_t count = setup.sites.voxels.voxel_count() / share;
    SeedSet seeds = place_seeds(setup.sites, setup.samples, {count, 3}, cpu);
    for (int64_t i = 0; i < 100; ++i) seeds.position[i] = seeds.position[i % 2], seeds.home[i] = seeds.home[i % 2];
    same_after({1, 2, 20}, seeds, 0, in_shell(setup));
  }
}
