// Voxelization against plain separating axes, voxel by voxel.
#include <algorithm>
#include <array>
#include <set>

#include "core/voxel_set.h"
#include "isoshell/advanced/digest.h"
#include "isoshell/error.h"
#include "oracle/overlap_oracle.h"
#include "support/catch.h"
#include "support/site_shapes.h"
#include "support/test_context.h"
#include "voxel/leaf.h"
#include "voxel/random.h"

using namespace isoshell;

namespace {

TriangleQ8 corners(const LatticeSurface& s, int64_t t) {
  const TriangleIndices i = s.triangles[t];
  return triangle_q8(s.points[i.a], s.points[i.b], s.points[i.c]);
}

std::set<std::array<int32_t, 3>> sites_by_axes(const LatticeSurface& s) {
  std::set<std::array<int32_t, 3>> sites;
  for (int64_t i = 0; i < s.triangles.size(); ++i) {
    const TriangleQ8 t = corners(s, i);
    int32_t lo[3], hi[3];
    for (int a = 0; a < 3; ++a) {
      lo[a] = std::min({t.at[0][a], t.at[1][a], t.at[2][a]}) / 256 - 1;
      hi[a] = std::max({t.at[0][a], t.at[1][a], t.at[2][a]}) / 256 + 1;
    }
    for (int32_t x = lo[0]; x <= hi[0]; ++x)
      for (int32_t y = lo[1]; y <= hi[1]; ++y)
        for (int32_t z = lo[2]; z <= hi[2]; ++z)
          if (oracle::meets_by_axes(t, {x, y, z}, kVoxelShift)) sites.insert({x, y, z});
  }
  return sites;
}

std::set<std::array<int32_t, 3>> voxels_of(const VoxelSet& set) {
  std::set<std::array<int32_t, 3>> out;
  for (int64_t l = 0; l < set.leaf_count(); ++l)
    for_each_active(set.view(), l, [&](int offset, int64_t) {
      const Voxel v = voxel_at(leaf_of_key(set.leaf_key[l]), offset);
      out.insert({v.x, v.y, v.z});
    });
  return out;
}

/// Wrong leaves, offsets or lookups of a voxel set.
int64_t index_faults(const VoxelSet& set) {
  int64_t faults = 0, index = 0;
  for (int64_t l = 0; l < set.leaf_count(); ++l) {
    faults += l > 0 && set.leaf_key[l - 1] >= set.leaf_key[l];
    faults += set.first[l] != index;
    faults += find_leaf(set.view(), leaf_of_key(set.leaf_key[l])) != uint32_t(l);
    const int64_t before = index;
    for_each_active(set.view(), l, [&](int offset, int64_t i) {
      faults += find_voxel(set.view(), voxel_at(leaf_of_key(set.leaf_key[l]), offset)) != i;
      ++index;
    });
    faults += index == before;
  }
  return faults + (set.voxel_count() != index);
}

}  // namespace

TEST_CASE("sites: exactly the voxels whose closed cube meets a closed triangle", "[sites][stage]") {
  TestContext context;
  for (const auto& [name, soup] : shapes::ugly_soups())
    for (int32_t resolution : {1, 9, 40}) {
      INFO(name << " at " << resolution);
      const LatticeSurface s = shapes::snapped(soup, resolution, context);
      const SiteSet sites = voxelize(s, context);
      CHECK(voxels_of(sites.voxels) == sites_by_axes(s));
      CHECK(index_faults(sites.voxels) == 0);
    }
}

TEST_CASE("sites: large triangles whose corners reach a little into a block keep every voxel", "[sites][stage]") {
  TestContext context;
  for (uint64_t seed = 0; seed < 40; ++seed) {
    // One corner at most 12 voxels inside the block that starts at 128 on every axis, two far outside of it.
    TriangleSoup soup;
    const auto at = [&](uint64_t i, double lo, double hi) {
      return lo + (hi - lo) * double(random_bits(seed, i) % 4096) / 4096;
    };
    soup.vertices.push_back({at(0, 100, 108), at(1, 100, 108), at(2, 100, 108)});
    soup.vertices.push_back({at(3, 2, 90), at(4, 2, 60), at(5, 2, 40)});
    soup.vertices.push_back({at(6, 2, 40), at(7, 2, 90), at(8, 2, 60)});
    soup.vertices.push_back({0, 0, 0});
    soup.vertices.push_back({160, 0, 0});
    soup.vertices.push_back({0, .1, 160});
    soup.triangles = {{0, 1, 2}, {3, 4, 5}};
    const LatticeSurface s = shapes::snapped(soup, 161, context);
    INFO("seed " << seed);
    const SiteSet sites = voxelize(s, context);
    REQUIRE(voxels_of(sites.voxels) == sites_by_axes(s));
    REQUIRE(index_faults(sites.voxels) == 0);
  }
}

TEST_CASE("sites: the index equals the one that is built from leaves and masks", "[sites][stage]") {
  TestContext context;
  const LatticeSurface s = shapes::snapped(shapes::torus(2, .7, 24, 12), 600, context);
  const SiteSet sites = voxelize(s, context);
  const VoxelSet& got = sites.voxels;
  VoxelSet expect;
  expect.leaf_key = Buffer<uint64_t>(got.leaf_count());
  expect.mask = Buffer<LeafMask>(got.leaf_count());
  std::copy(got.leaf_key.begin(), got.leaf_key.end(), expect.leaf_key.begin());
  std::copy(got.mask.begin(), got.mask.end(), expect.mask.begin());
  index_host_leaves(expect, s.frame.extent_vox);
  CHECK(std::equal(got.block_dims, got.block_dims + 3, expect.block_dims));
  CHECK(std::equal(got.first.begin(), got.first.end(), expect.first.begin(), expect.first.end()));
  CHECK(
      std::equal(got.block_table.begin(), got.block_table.end(), expect.block_table.begin(), expect.block_table.end()));
  REQUIRE(got.blocks.size() == expect.blocks.size());
  int64_t wrong = 0;
  for (int64_t b = 0; b < got.blocks.size(); ++b)
    wrong += got.blocks[b].first_leaf != expect.blocks[b].first_leaf ||
             !std::equal(got.blocks[b].word, got.blocks[b].word + 64, expect.blocks[b].word) ||
             !std::equal(got.blocks[b].before, got.blocks[b].before + 64, expect.blocks[b].before);
  CHECK(wrong == 0);
}

TEST_CASE("sites: triangles on voxel boundaries occupy the voxels on both sides", "[sites][stage]") {
  TestContext context;
  const LatticeSurface s = shapes::on_voxel_boundaries(context);
  for (PointQ8 p : s.points) REQUIRE((p.x % 256 == 0 && p.y % 256 == 0 && p.z % 256 == 0));
  CHECK(voxels_of(voxelize(s, context).voxels) == sites_by_axes(s));
}

TEST_CASE("sites: a surface outside its lattice is refused", "[sites][stage]") {
  TestContext context;
  LatticeSurface s = shapes::snapped(shapes::box({0, 0, 0}, {1, 1, 1}), 8, context);
  s.points[0].x = s.frame.extent_vox[0] * kOneVoxelQ8;
  CHECK_THROWS_AS(voxelize(s, context), Error);
  CHECK_THROWS_AS(voxelize(LatticeSurface{}, context), Error);
}

TEST_CASE("sites: order of the file and threads change nothing", "[sites][stage][parity]") {
  for (const auto& [name, soup] : shapes::ugly_soups()) {
    INFO(name);
    TestContext one, two;
    one.threads = 1;
    two.threads = 2;
    const uint64_t expect = digest(voxelize(shapes::snapped(soup, 150, one), one));
    for (uint64_t seed = 0; seed < 2; ++seed)
      CHECK(digest(voxelize(shapes::snapped(shapes::shuffled(soup, seed), 150, two), two)) == expect);
  }
}

TEST_CASE("sites: triangles across the largest lattice are exact and cost only their voxels", "[sites][stage]") {
  TestContext context;
  TriangleSoup soup;
  soup.vertices = {{0, 0, 0}, {1, 1, 1}, {1, .999, .9995}, {.001, .0005, 0}};
  soup.triangles = {{0, 1, 2}, {0, 1, 3}};
  const LatticeSurface s = shapes::snapped(soup, kMaxResolution, context);
  const SiteSet sites = voxelize(s, context);
  CHECK(index_faults(sites.voxels) == 0);
  // Site or not, by separating axes, in windows around points of both triangles.
  int64_t wrong = 0, met = 0;
  for (int64_t i = 0; i < 200; ++i) {
    const TriangleQ8 t = corners(s, i & 1);
    const int64_t u = i % 13, v = (i / 13) % (14 - u);
    int32_t at[3];
    for (int a = 0; a < 3; ++a)
      at[a] = int32_t((t.at[0][a] * (13 - u - v) + t.at[1][a] * u + t.at[2][a] * v) / 13 / 256);
    for (int n = 0; n < 125; ++n) {
      const Voxel x = {at[0] + n % 5 - 2, at[1] + n / 5 % 5 - 2, at[2] + n / 25 - 2};
      const bool on = find_voxel(sites.voxels.view(), x) >= 0;
      met += on;
      wrong += on != (oracle::meets_by_axes(corners(s, 0), x, kVoxelShift) ||
                      oracle::meets_by_axes(corners(s, 1), x, kVoxelShift));
    }
  }
  CHECK(wrong == 0);
  CHECK(met > 1000);
}
