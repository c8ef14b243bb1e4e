// The paper's Lloyd loop: labels, sums, step, projection, stop rule.
#include "cpu/executor_tbb.h"
#include "isoshell/advanced/digest.h"
#include "isoshell/error.h"
#include "oracle/lloyd.h"
#include "stages/shell/nearest_seed_body.h"
#include "stages/shell/relax_shell_body.h"
#include "support/catch.h"
#include "support/paper_setup.h"
#include "support/test_context.h"

using namespace isoshell;

namespace {

/// A sink of LabelLeaf that writes the labels down.
struct WriteLabels {
  VoxelSetView voxels;
  View<uint32_t> label;

  struct Cube {
    const WriteLabels& to;
    int64_t leaf;
    const PointList& near;
    ISOSHELL_HD void voxel(int number, int offset, int64_t) const { to.voxel(leaf, offset, near.id[number]); }
    ISOSHELL_HD void finish() const {}
  };
  ISOSHELL_HD Cube open(int64_t leaf, const PointList& near) const { return {*this, leaf, near}; }
  ISOSHELL_HD void voxel(int64_t leaf, int offset, uint32_t seed) const {
    label[voxels.first[leaf] + rank_in_leaf(voxels.mask[leaf], offset)] = seed;
  }
};

std::vector<uint32_t> labels_of(const VoxelSet& voxels, const std::vector<PointQ8>& seeds, int64_t spacing) {
  TestContext context;
  PlainExecutor exec(context, "test");
  PointGrid grid = make_point_grid(exec, BlockExtent(voxels.view()).vox, spacing, int64_t(seeds.size()));
  std::vector<PointQ8> copy = seeds;
  Buffer<uint32_t> label = exec.template make<uint32_t>(voxels.voxel_count());
  Buffer<int32_t> reach_q8 = exec.template make<int32_t>(voxels.leaf_count());
  exec.fill(reach_q8.view(), int32_t(1) << grid.shift);
  fill_point_grid(exec, grid, View<const PointQ8>{copy.data(), int64_t(copy.size())});
  exec.for_each(
      "nearest seed", voxels.leaf_count(),
      LabelLeaf<WriteLabels>{voxels.view(), grid.view(), WriteLabels{voxels.view(), label.view()}, reach_q8.view(), 0});
  return {label.data(), label.data() + label.size()};
}

void check_labels(const VoxelSet& voxels, const std::vector<PointQ8>& seeds) {
  const std::vector<uint32_t> expect = oracle::nearest_seeds(voxels, seeds);
  for (const int64_t spacing : {1, 5, 40}) CHECK(labels_of(voxels, seeds, spacing) == expect);
}

/// How many cubes of this edge have too many candidates for a list.
int64_t overflows(const VoxelSet& voxels, const std::vector<PointQ8>& seeds, int edge) {
  TestContext context;
  PlainExecutor exec(context, "test");
  PointGrid grid = make_point_grid(exec, BlockExtent(voxels.view()).vox, 4, int64_t(seeds.size()));
  std::vector<PointQ8> copy = seeds;
  fill_point_grid(exec, grid, {copy.data(), int64_t(copy.size())});
  int64_t count = 0;
  for (int64_t l = 0; l < voxels.leaf_count(); ++l)
    for (int x = 0; x < 8; x += edge)
      for (int y = 0; y < 8; y += edge)
        for (int z = 0; z < 8; z += edge) {
          const LeafCube cube = cube_of_leaf(voxels.mask[l], edge, x, y, z);
          if (cube.empty()) continue;
          PointList near;
          const PointQ8 origin = voxel_centre(voxel_at(leaf_of_key(voxels.leaf_key[l]), 0));
          gather_near(grid.view(), origin, box_of_centres(cube), kOneVoxelQ8, near);
          count += near.count > kMaxNear;
        }
  return count;
}

/// Seeds at random in the voxels 116 to 123 of each axis: the most are more than the voxels of a shell there.
std::vector<PointQ8> crowd(int count) {
  std::vector<PointQ8> out;
  for (int i = 0; i < count; ++i) {
    const uint64_t r = random_bits(5, uint64_t(i));
    const auto coordinate = [&](int shift) { return 116 * kOneVoxelQ8 + int32_t(r >> shift & 0x7ff); };
    out.push_back({coordinate(0), coordinate(11), coordinate(22)});
  }
  return out;
}

/// Seeds with a home where a pass needs one.
SeedSet seeds_on(const PaperSetup& setup, const std::vector<PointQ8>& positions) {
  SeedSet seeds = seeds_at(positions);
  for (int64_t i = 0; i < seeds.size(); ++i) {
    const int64_t voxel = find_voxel(setup.shell.voxels.view(), voxel_of(seeds.position[i]));
    if (voxel >= 0) seeds.home[i] = setup.shell.closest_site[voxel];
  }
  return seeds;
}

}  // namespace

TEST_CASE("nearest seed: equals brute force, ties to the smaller id", "[relax_shell][stage]") {
  TestContext context;
  for (const auto& shape : voxel_shapes::all(12)) {
    const PaperSetup setup = paper_setup(shape, 2);
    for (const int64_t k : {int64_t(4), int64_t(60), setup.sites.voxels.voxel_count() / 2}) {
      if (k < 4 || k > setup.sites.voxels.voxel_count() / 2 || k * setup.shell.voxels.voxel_count() > 20000000)
        continue;
      std::vector<PointQ8> seeds = positions(place_seeds(setup.sites, setup.samples, {k, 1}, context));
      check_labels(setup.shell.voxels, seeds);
      // On voxel centres every second voxel is a tie.
      for (PointQ8& p : seeds) p = voxel_centre(voxel_of(p));
      check_labels(setup.shell.voxels, seeds);
    }
  }
}

TEST_CASE("nearest seed: exact where candidate lists overflow", "[relax_shell][stage]") {
  const PaperSetup setup = paper_setup(ball_skin(14), 2);
  std::vector<PointQ8> dense;
  for (Voxel v : voxels_of(setup.sites.voxels)) dense.push_back(voxel_centre(v));
  check_labels(setup.shell.voxels, dense);
  CHECK(overflows(setup.shell.voxels, crowd(3000), 8) > 0);
  check_labels(setup.shell.voxels, crowd(3000));
  // A heap of seeds in one place, and rings at the same distance of one voxel: nothing can be dropped.
  std::vector<PointQ8> heap(2 * kMaxNear, voxel_centre({128, 128, 114}));
  for (int i = 0; i < 2 * kMaxNear; ++i) heap.push_back({heap[0].x + i, heap[0].y - i * i, heap[0].z});
  CHECK(overflows(setup.shell.voxels, heap, 4) > 0);
  check_labels(setup.shell.voxels, heap);
}

TEST_CASE("nearest seed: exact when seeds are hundreds of voxels away", "[relax_shell][stage]") {
  const auto shape = voxel_shapes::filled("bars", {256, 256, 256}, 200, {512, 512, 512},
                                          [](int x, int y, int z) { return (x | y) == 0 && (z & 7) < 3; });
  const PaperSetup setup = paper_setup(shape, 1);
  check_labels(setup.shell.voxels, {{65536, 65536, 15000}, {65530, 65540, 15100}, {65540, 65536, 15100}});
}

TEST_CASE("nearest seed: exact for any number of seeds in a leaf", "[relax_shell][stage]") {
  const PaperSetup setup = paper_setup(ball_skin(10), 2);
  for (const int count : {1, 3, 9, 33, 70, kMaxNear, kMaxNear + 1, 900}) check_labels(setup.shell.voxels, crowd(count));
}

namespace {

/// Relaxes for one pass and compares with sums over all voxels and seeds.
void check_one_pass(const PaperSetup& setup, SeedSet seeds, int32_t most) {
  TestContext context;
  const std::vector<PointQ8> before = positions(seeds);
  const std::vector<oracle::Cell> cells = oracle::cells(setup.shell.voxels, before);
  const RelaxReport report = relax_in_shell(setup.shell, setup.sites, setup.samples, seeds, {1, 0, most}, context);
  int64_t energy = 0;
  for (int64_t i = 0; i < seeds.size(); ++i) {
    const oracle::Cell& cell = cells[size_t(i)];
    const PointQ8 p = before[size_t(i)];
    energy += cell.energy_q16;
    if (cell.count == 0) {
      CHECK(seeds.position[i] == p);
      continue;
    }
    const Vec64 step = {round_div(cell.moment.x, cell.count), round_div(cell.moment.y, cell.count),
                        round_div(cell.moment.z, cell.count)};
    const Vec64 made = difference(seeds.position[i], p);
    const PointQ8 centre = {p.x + int32_t(step.x), p.y + int32_t(step.y), p.z + int32_t(step.z)};
    const bool stays = find_voxel(setup.shell.voxels.view(), voxel_of(centre)) >= 0;
    if (dot(step, step) <= int64_t(most) * most) {
      CHECK((!stays || seeds.position[i] == centre));
    } else if (find_voxel(setup.shell.voxels.view(), voxel_of(seeds.position[i])) >= 0 && most < 256) {
      CHECK(dot(made, made) <= int64_t(most + 1) * (most + 1));
      CHECK(dot(made, made) >= int64_t(most - 2) * (most - 2));
      CHECK(dot(made, step) > 0);
    }
    CHECK(find_voxel(setup.shell.voxels.view(), voxel_of(seeds.position[i])) >= 0);
  }
  CHECK(report.energy[0] == double(energy >> 8));
}

}  // namespace

TEST_CASE("relax in shell: one pass moves every seed to the mean of its voxels, at most u", "[relax_shell][stage]") {
  TestContext context;
  for (const auto& shape : {ball_skin(17), voxel_shapes::all(20)[1]}) {
    const PaperSetup setup = paper_setup(shape, 3);
    for (const int32_t most : {1 << 20, 256, 40})
      check_one_pass(setup, place_seeds(setup.sites, setup.samples, {40, 9}, context), most);
  }
}

TEST_CASE("relax in shell: one pass is right for crowds of seeds, in one place, and leaves away from most voxels",
          "[relax_shell][stage]") {
  const PaperSetup setup = paper_setup(ball_skin(17), 2);
  for (const int count : {4, 40, 400, 3000}) check_one_pass(setup, seeds_on(setup, crowd(count)), 1 << 20);
  std::vector<PointQ8> heap = crowd(50);
  for (size_t i = 10; i < heap.size(); ++i) heap[i] = heap[i % 3];
  check_one_pass(setup, seeds_on(setup, heap), 1 << 20);
  const PaperSetup large = paper_setup(ball_skin(70), 2);
  check_one_pass(large, seeds_on(large, {voxel_centre({58, 128, 128}), voxel_centre({128, 198, 128})}), 1 << 20);
}

TEST_CASE("relax in shell: a seed that leaves the shell goes to a sample of a site near by", "[relax_shell][stage]") {
  const PaperSetup setup = paper_setup(ball_skin(17), 1);
  TestContext context;
  SeedSet seeds = place_seeds(setup.sites, setup.samples, {6, 9}, context);
  relax_in_shell(setup.shell, setup.sites, setup.samples, seeds, {1, 0, 1 << 20}, context);
  const std::vector<Voxel> voxel = voxels_of(setup.sites.voxels);
  for (int64_t i = 0; i < seeds.size(); ++i) {
    // Six caps of a sphere have their mean centres far inside it.
    const SiteSample& s = setup.samples.sample[seeds.home[i]];
    const PointQ8 c = voxel_centre(voxel[seeds.home[i]]);
    CHECK(seeds.position[i] == PointQ8{c.x + s.dx, c.y + s.dy, c.z + s.dz});
    CHECK(dot(seeds.normal[i], s.normal) == dot(s.normal, s.normal));
  }
}

TEST_CASE("relax in shell: the energy falls, and the tolerance stops the loop", "[relax_shell][stage]") {
  const PaperSetup setup = paper_setup(ball_skin(40), 2);
  TestContext context;
  SeedSet seeds = place_seeds(setup.sites, setup.samples, {150, 3}, context);
  const RelaxReport report = relax_in_shell(setup.shell, setup.sites, setup.samples, seeds, {400, 100000, 0}, context);
  CHECK(report.converged);
  CHECK(report.passes < 400);
  REQUIRE(report.energy.size() == size_t(report.passes));
  CHECK(report.energy.back() < .9 * report.energy.front());
  // Samples here lie anywhere in their voxel, so only projections can lift the energy, and only by little.
  for (size_t i = 1; i < report.energy.size(); ++i) CHECK(report.energy[i] <= report.energy[i - 1] * 1.001);
  CHECK(report.energy.back() * report.normalised_energy_factor > .1);
  CHECK(report.energy.back() * report.normalised_energy_factor < .4);
}

TEST_CASE("relax in shell: the same for any number of threads", "[relax_shell][stage]") {
  const PaperSetup setup = paper_setup(ball_skin(40), 2);
  uint64_t one = 0;
  for (const int threads : {1, 2, 3}) {
    TestContext context;
    context.threads = threads;
    SeedSet seeds = place_seeds(setup.sites, setup.samples, {400, 3}, context);
    relax_in_shell(setup.shell, setup.sites, setup.samples, seeds, {25, 0, 0}, context);
    if (threads == 1) one = digest(seeds);
    CHECK(digest(seeds) == one);
  }
}

TEST_CASE("relax in shell: an empty cell keeps its seed", "[relax_shell][stage]") {
  const PaperSetup setup = paper_setup(ball_skin(17), 2);
  TestContext context;
  SeedSet seeds = place_seeds(setup.sites, setup.samples, {10, 3}, context);
  seeds.position[7] = seeds.position[2];
  const PointQ8 before = seeds.position[7];
  relax_in_shell(setup.shell, setup.sites, setup.samples, seeds, {1, 0, 0}, context);
  CHECK(seeds.position[7] == before);
  CHECK(seeds.position[2] != before);
}

TEST_CASE("relax in shell: the stop rule compares integers of any size", "[relax_shell][unit]") {
  const auto stalled = [](std::initializer_list<int64_t> energies, int32_t tolerance_ppb) {
    PassState state{};
    for (int64_t e : energies) state.add(e);
    return relax_shell::stalled(state, tolerance_ppb);
  };
  CHECK_FALSE(stalled({10, 10, 10, 10, 10}, 1));
  CHECK(stalled({10, 10, 10, 10, 10, 10}, 100000000));
  const int64_t big = int64_t(1) << 58;
  CHECK(stalled({big, 0, 0, 0, 0, big - 1}, 10000));
  CHECK_FALSE(stalled({big, 0, 0, 0, 0, big / 2}, 10000));
  CHECK_FALSE(stalled({big, 0, 0, 0, 0, big / 2}, 1000000));
}
