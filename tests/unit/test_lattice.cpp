// The lattice and the leaf arithmetic.
#include <cmath>

#include "core/voxel_set.h"
#include "isoshell/advanced/lattice.h"
#include "isoshell/error.h"
#include "support/catch.h"
#include "voxel/exact_int.h"
#include "voxel/leaf.h"
#include "voxel/random.h"

using namespace isoshell;

TEST_CASE("lattice: the longest side spans exactly `resolution` voxels", "[lattice][unit]") {
  const LatticeFrame f = LatticeFrame::around({-1, 2, 3}, {4, 3, 3.5}, 64);
  const PointQ8 lo = f.snap({-1, 2, 3}), hi = f.snap({4, 3, 3.5});
  CHECK(lo.x == kMarginVox * 256 + 128);
  CHECK((hi.x >> 8) - (lo.x >> 8) == 63);
  CHECK(f.extent_vox[0] % 8 == 0);
  CHECK(f.extent_vox[0] >= 64 + 2 * kMarginVox);
  CHECK_THROWS_AS(LatticeFrame::around({0, 0, 0}, {1, 1, 1}, kMaxResolution + 1), Error);
}

TEST_CASE("lattice: one of a voxel size lies on its multiples, by whole leaves, with its margins", "[lattice][unit]") {
  for (const double voxel : {.1, 1. / 3, .007}) {
    const WorldPoint low{-1.234, 2.5, 1003.21}, high{.777, 3.01, 1004};
    const LatticeFrame f = LatticeFrame::on_multiples(low, high, voxel);
    CHECK(f.voxel_size == voxel);
    CHECK(f.resolution == int32_t(std::floor(2.011 / voxel + .5)) + 1);
    const IndexSpace index = f.index_space();
    CHECK((index.zero_world.x == 0 && index.zero_world.y == 0 && index.zero_world.z == 0));
    CHECK((index.first.x % 8 == 0 && index.first.y % 8 == 0 && index.first.z % 8 == 0));
    CHECK(f.origin.x == Approx((index.first.x - .5) * voxel));
    CHECK(f.origin.z == Approx((index.first.z - .5) * voxel));
    const PointQ8 lo = f.snap(low), hi = f.snap(high);
    for (const int32_t at : {lo.x, lo.y, lo.z}) CHECK((at >= kMarginVox * 256 && at < (kMarginVox + 8) * 256));
    CHECK((hi.x < (f.extent_vox[0] - kMarginVox) * 256 && hi.z < (f.extent_vox[2] - kMarginVox) * 256));
    LatticeFrame moved = f;
    moved.origin.y += .3 * voxel;
    CHECK(moved.index_space().first == Voxel{0, 0, 0});
    CHECK(moved.index_space().zero_world.y == moved.origin.y + voxel / 2);
  }
  for (double low = 0; low < 16; low += .37) {  // however the largest lattice lies on whole leaves
    const LatticeFrame largest = LatticeFrame::on_multiples({low, 0, 0}, {low + kMaxResolution - .6, 1, 1}, 1);
    CHECK(largest.resolution == kMaxResolution);
    CHECK(largest.extent_vox[0] <= kMaxExtentVox);
  }
  CHECK_THROWS_AS(LatticeFrame::on_multiples({0, 0, 0}, {1, 1, 1}, 1e-5), Error);
  CHECK_THROWS_AS(LatticeFrame::on_multiples({0, 0, 0}, {0, 0, 0}, 1), Error);
  const IndexSpace far = LatticeFrame::on_multiples({1e9, 0, 0}, {1e9 + 1, 1, 1}, .1).index_space();
  CHECK((far.first == Voxel{0, 0, 0} && far.zero_world.x != 0));  // 32 bits do not number these
}

TEST_CASE("leaf: a key and its leaf are each other's inverse and order as NanoVDB does", "[leaf][unit]") {
  for (uint64_t i = 0; i < 1000; ++i) {
    const uint64_t r = random_bits(1, i);
    const Voxel leaf = {int32_t(r & 0x7ffff), int32_t(r >> 20 & 0x7ffff), int32_t(r >> 40 & 0x7ffff)};
    CHECK(leaf_of_key(leaf_key(leaf)) == leaf);
  }
  CHECK(leaf_key({15, 15, 15}) < leaf_key({0, 0, 16}));
  CHECK(leaf_key({0, 0, 511}) < leaf_key({0, 0, 512}));
}

TEST_CASE("voxel set: every active voxel is found at its index and no other is", "[voxel_set][unit]") {
  VoxelSet set;
  set.leaf_key = Buffer<uint64_t>(40);
  set.mask = Buffer<LeafMask>(40);
  for (int64_t l = 0; l < 40; ++l) {
    set.leaf_key[l] = uint64_t(l * l * 7 + l);
    for (int w = 0; w < 8; ++w) set.mask[l].word[w] = random_bits(2, uint64_t(l * 8 + w));
  }
  const int32_t extent[3] = {4096, 4096, 4096};
  index_host_leaves(set, extent);
  const VoxelSetView view = set.view();
  for (int64_t l = 0; l < 40; ++l) {
    int64_t expect = set.first[l];
    for (int offset = 0; offset < 512; ++offset) {
      const Voxel v = voxel_at(leaf_of_key(set.leaf_key[l]), offset);
      CHECK(find_voxel(view, v) == (is_on(set.mask[l], offset) ? expect++ : -1));
    }
  }
  CHECK(find_voxel(view, {-1, 0, 0}) == -1);
}

TEST_CASE("exact integers: rounding division and square root are what they say", "[exact][unit]") {
  CHECK(round_div(5, 2) == 3);
  CHECK(round_div(-5, 2) == -2);
  CHECK(floor_div(-1, 4) == -1);
  for (uint64_t n : {0ull, 1ull, 3ull, 4ull, 99ull, 1ull << 61, (1ull << 62) - 1}) {
    const uint64_t r = isqrt(n);
    CHECK(r * r <= n);
    CHECK((r + 1) * (r + 1) > n);
  }
  const Normal8 n = normal8({3, 4, 0});
  CHECK(n.x == 76);
  CHECK(n.y == 102);
}
