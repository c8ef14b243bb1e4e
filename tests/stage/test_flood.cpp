// The flood against its definition, round by round.
#include "isoshell/advanced/digest.h"
#include "oracle/lloyd.h"
#include "support/catch.h"
#include "support/paper_setup.h"
#include "support/test_context.h"
#include "voxel/dilate.h"

using namespace isoshell;

namespace {

std::vector<uint32_t> flood_of(const Shell& shell, const SeedSet& seeds, int threads = 0) {
  TestContext context;
  context.threads = threads;
  const VoronoiLabels labels = flood_shell(shell, seeds, context);
  return {labels.voxel_seed.data(), labels.voxel_seed.data() + labels.voxel_seed.size()};
}

}  // namespace

TEST_CASE("flood: equals the synchronous rounds of its definition", "[flood][stage]") {
  TestContext context;
  for (const auto& shape : voxel_shapes::all(16)) {
    for (const int32_t band_vox : {1, 3}) {
      const PaperSetup setup = paper_setup(shape, band_vox);
      for (const int64_t k : {4, 50, 400}) {
        if (k > setup.sites.voxels.voxel_count() / 2) continue;
        const SeedSet seeds = place_seeds(setup.sites, setup.samples, {k, 2}, context);
        CHECK(flood_of(setup.shell, seeds) == oracle::flood(setup.shell.voxels, positions(seeds)));
      }
    }
  }
}

TEST_CASE("flood: seeds in one voxel, on ties and outside the shell start as defined", "[flood][stage]") {
  const PaperSetup setup = paper_setup(ball_skin(17), 1);
  const PointQ8 c = voxel_centre({128, 128, 145});
  const std::vector<PointQ8> seeds = {{c.x + 9, c.y, c.z},   {c.x, c.y + 8, c.z},           {c.x, c.y - 8, c.z},
                                      {32768, 32768, 32768}, {32768 + 64, 32768, 32768},    {0, 0, 0},
                                      {65535, 65535, 65535}, voxel_centre({111, 128, 128}), {32768, 20000, 45000}};
  CHECK(flood_of(setup.shell, seeds_at(seeds)) == oracle::flood(setup.shell.voxels, seeds));
}

TEST_CASE("flood: a component without a seed stays without label", "[flood][stage]") {
  const auto shape = voxel_shapes::filled("two walls", {64, 64, 64}, 12, {128, 128, 128},
                                          [](int x, int, int) { return x == -6 || x == 6; });
  const PaperSetup setup = paper_setup(shape, 2);
  const std::vector<PointQ8> seeds = {voxel_centre({58, 64, 64}), voxel_centre({58, 70, 60})};
  const std::vector<uint32_t> label = flood_of(setup.shell, seeds_at(seeds));
  CHECK(label == oracle::flood(setup.shell.voxels, seeds));
  const std::vector<Voxel> voxel = voxels_of(setup.shell.voxels);
  for (size_t i = 0; i < voxel.size(); ++i) CHECK((label[i] == kNone) == (voxel[i].x > 64));
  for (uint32_t l : flood_of(setup.shell, seeds_at({}))) CHECK(l == kNone);
}

TEST_CASE("flood: labels follow the shell, not the straight line", "[flood][stage]") {
  // A hairpin: two bars 6 voxels apart that meet at one end. The seed at the open end of one bar is nearer to the other
  // bar than that bar's own seed, but far along the shell.
  const auto shape = voxel_shapes::filled("hairpin", {64, 64, 64}, 40, {128, 128, 128}, [](int x, int y, int z) {
    return y == 0 && ((x >= -40 && x <= 0 && (z == -3 || z == 3)) || (x == 0 && z >= -3 && z <= 3));
  });
  const PaperSetup setup = paper_setup(shape, 1);
  const SeedSet seeds = seeds_at({voxel_centre({26, 64, 61}), voxel_centre({50, 64, 67})});
  const std::vector<uint32_t> label = flood_of(setup.shell, seeds);
  CHECK(label[size_t(find_voxel(setup.shell.voxels.view(), {26, 64, 67}))] == 1);
}

TEST_CASE("flood: the same for any number of threads", "[flood][stage]") {
  TestContext context;
  const PaperSetup setup = paper_setup(ball_skin(60), 3);
  const SeedSet seeds = place_seeds(setup.sites, setup.samples, {300, 2}, context);
  const std::vector<uint32_t> one = flood_of(setup.shell, seeds, 1);
  CHECK(one == flood_of(setup.shell, seeds, 2));
  CHECK(one == flood_of(setup.shell, seeds, 3));
}

TEST_CASE("dilate: a mask grown by 26 neighbours is what its voxels say", "[flood][unit]") {
  for (uint64_t round = 0; round < 60; ++round) {
    LeafMask masks[27];
    const LeafMask* around[27];
    for (int n = 0; n < 27; ++n) {
      around[n] = random_bits(11, round * 27 + uint64_t(n)) % 3 ? &masks[n] : nullptr;
      for (int w = 0; w < 8; ++w) {
        uint64_t bits = ~uint64_t(0);
        for (uint64_t sparse = 0; sparse < 5; ++sparse) bits &= random_bits(round + 100 * sparse, uint64_t(n * 8 + w));
        masks[n].word[w] = bits;
      }
    }
    const auto in_set = [&](int x, int y, int z) {
      const LeafMask* mask = around[neighbour_number(x >> 3, y >> 3, z >> 3)];
      return mask && is_on(*mask, (x & 7) << 6 | (y & 7) << 3 | (z & 7));
    };
    const LeafMask grown = dilate_26(around);
    bool touched[27] = {};
    for (int x = 0; x < 8; ++x)
      for (int y = 0; y < 8; ++y)
        for (int z = 0; z < 8; ++z) {
          bool expect = false;
          for (int n = 0; n < 27; ++n) {
            const int nx = x + n / 9 - 1, ny = y + n / 3 % 3 - 1, nz = z + n % 3 - 1;
            expect = expect || in_set(nx, ny, nz);
            if (in_set(x, y, z)) touched[neighbour_number(nx >> 3, ny >> 3, nz >> 3)] = true;
          }
          CHECK(is_on(grown, x << 6 | y << 3 | z) == expect);
        }
    if (around[13])
      for (int n = 0; n < 27; ++n) CHECK(reaches(masks[13], n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1) == touched[n]);
  }
}
