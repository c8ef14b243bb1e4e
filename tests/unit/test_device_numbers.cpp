// The arithmetic that only the device's kernels use, checked on the host: prepared overlap tests and ranks of sites.
#include <algorithm>
#include <string>
#include <vector>

#include "cuda/shell/site_order.h"
#include "cuda/sites/overlap_plan.h"
#include "support/catch.h"
#include "voxel/leaf.h"
#include "voxel/random.h"

using namespace isoshell;

namespace {

/// Random triangles of many sizes; every eighth kind has no area, lies in a plane of voxel faces or is seen edge-on.
TriangleQ8 some_triangle(uint64_t seed) {
  uint64_t state = seed << 8;
  const auto below = [&](int64_t n) { return int32_t(random_bits(9, state++) % uint64_t(n)); };
  const int32_t sizes[] = {1, 3, 60, 300, 2000, 15000, 100000, 2000000}, size = sizes[seed % 8];
  const int32_t corner = 1 + below(2100000 - size);
  TriangleQ8 t;
  for (auto& point : t.at)
    for (int32_t& c : point) c = corner + below(size);
  const auto kind = seed / 8 % 8;
  for (int v = 0; v < 3; ++v) {
    if (kind == 1) t.at[v][0] = t.at[0][0];
    if (kind == 2) t.at[v][2] = t.at[0][2];
    if (kind == 3) t.at[v][below(3)] = t.at[0][0];
    if (kind == 4) t.at[v][1] = t.at[0][1] / 256 * 256 + 256;
  }
  if (kind == 5) std::copy(t.at[1], t.at[1] + 3, t.at[2]);
  if (kind == 6)
    for (int axis = 0; axis < 3; ++axis) t.at[2][axis] = (t.at[0][axis] + t.at[1][axis]) / 2;
  return t;
}

/// The bounding range within one window of the lattice that the triangle meets.
CellRange window_of(const TriangleQ8& t, uint64_t seed) {
  const int64_t u = int64_t(random_bits(10, seed) % 1000), v = int64_t(random_bits(11, seed) % uint64_t(1001 - u));
  CellRange window;
  for (int axis = 0; axis < 3; ++axis) {
    const int64_t at = (t.at[0][axis] * (1000 - u - v) + t.at[1][axis] * u + t.at[2][axis] * v) / 1000;
    window.lo[axis] = int32_t(at >> 15) * 128;
    window.hi[axis] = window.lo[axis] + 127;
  }
  return common_range(bounding_range(t, kVoxelShift), window);
}

/// What eight lanes of mark_voxels_of_leaves compute.
LeafMask voxels_by_plan(const overlap_plan::Plan& plan, const int32_t at[3]) {
  using namespace overlap_plan;
  LeafMask mask = {};
  const uint32_t ys = range_bits(-at[1], plan.last[1] - at[1]), zs = range_bits(-at[2], plan.last[2] - at[2]);
  for (int x = 0; x < 8; ++x) {
    if (at[0] + x < 0 || at[0] + x > plan.last[0]) continue;
    const uint32_t rows = shadow_row(plan.side[0], at[0] + x, at[1]) & ys;
    const uint32_t xz = shadow_row(plan.side[1], at[0] + x, at[2]) & zs;
    PlaneValues plane = plane_at(plan, at[0] + x, at[1], at[2]);
    for (int y = 0; y < 8; ++y) {
      uint32_t row = rows >> y & 1 ? xz & shadow_row(plan.side[2], at[1] + y, at[2]) : 0;
      const int64_t nz = joined(plan.normal[2]);
      row &= plan.narrow ? plane_column(int32_t(plane.low), int32_t(plane.high), int32_t(nz))
                         : plane_column(plane.low, plane.high, nz);
      mask.word[x] |= uint64_t(row) << (8 * y);
      plane.low += joined(plan.normal[1]);
      plane.high += joined(plan.normal[1]);
    }
  }
  return mask;
}

/// Whether ranks, one a leaf of the window, are in the order of the leaves' keys.
bool in_order(std::vector<std::pair<uint64_t, int64_t>>& key_and_rank) {
  std::sort(key_and_rank.begin(), key_and_rank.end());
  for (size_t i = 1; i < key_and_rank.size(); ++i)
    if (key_and_rank[i].second <= key_and_rank[i - 1].second) return false;
  return true;
}

}  // namespace

TEST_CASE("overlap plan: the same leaves and voxels as the overlap test itself", "[sites][unit]") {
  int64_t wrong = 0, met = 0;
  for (uint64_t seed = 0; seed < 6000; ++seed) {
    const TriangleQ8 t = some_triangle(seed);
    CellRange range = window_of(t, seed);
    overlap_plan::Plan plan;
    if (!make_plan(t, range, plan)) continue;
    const CellRange whole = bounding_range(t, kVoxelShift);
    constexpr int32_t kMost = overlap_plan::kSmallSpan;
    const bool small =
        whole.hi[0] - whole.lo[0] <= kMost && whole.hi[1] - whole.lo[1] <= kMost && whole.hi[2] - whole.lo[2] <= kMost;
    if (small && seed % 3) {
      make_small_plan(t, whole, plan);
      range = whole;
    }
    int looked_at = 0;
    for (int32_t x = range.lo[0] >> 3; x <= range.hi[0] >> 3; ++x)
      for (int32_t y = range.lo[1] >> 3; y <= range.hi[1] >> 3; ++y)
        for (int32_t z = range.lo[2] >> 3; z <= range.hi[2] >> 3 && looked_at < 200; ++z, ++looked_at) {
          LeafMask expected = {};
          mark_voxels(t, {x, y, z}, expected);
          const int32_t at[3] = {x * 8 - plan.base[0], y * 8 - plan.base[1], z * 8 - plan.base[2]};
          const bool meets = overlap_plan::meets_leaf(plan, at[0], at[1], at[2]);
          const LeafMask mask = meets ? voxels_by_plan(plan, at) : LeafMask{};
          bool some = false;
          if (range.lo[0] == whole.lo[0] && range.lo[1] == whole.lo[1] && range.lo[2] == whole.lo[2] && is_tiny(plan))
            for (int32_t i = 0; i < 64; ++i) {
              const int32_t a = at[0] + i / 8, b = at[1] + i % 8;
              if (a < 0 || b < 0 || a > plan.last[0] || b > plan.last[1]) continue;
              const uint64_t column = overlap_plan::column_bits(plan, a, b);
              const uint64_t row = at[2] < 0 ? column << -at[2] : column >> at[2];
              wrong += (expected.word[i / 8] >> (8 * (i % 8)) & 255) != (row & 255);
            }
          for (int w = 0; w < 8; ++w) {
            wrong += mask.word[w] != expected.word[w];
            some |= expected.word[w] != 0;
          }
          wrong += meets != some;
          met += some;
        }
  }
  CHECK(wrong == 0);
  CHECK(met > 1000);
}

TEST_CASE("site order: ranks around a row of leaves follow the leaf keys, whatever borders they cross",
          "[shell][unit]") {
  int64_t wrong = 0;
  for (const int32_t x : {0, 8, 16, 504, 512, 1016})
    for (const int32_t y : {7, 15, 16, 17, 511, 512, 1022})
      for (const int32_t z : {5, 14, 15, 16, 510, 511, 512, 513}) {
        for (int leaf = 0; leaf < 8; ++leaf) {
          const bool over_border = site_order::is_mixed({x, y, z}) && leaf == site_order::border_leaf({x, y, z});
          const auto small = site_order::small_order({x, y, z}, over_border);
          std::vector<std::pair<uint64_t, int64_t>> ranks;
          for (int i = 0; i < 27; ++i) {
            const int at[3] = {i / 9, i / 3 % 3, i % 3};
            const int rank = small.leaf(0, at[0]) + small.leaf(1, at[1]) + small.leaf(2, at[2]);
            wrong += rank < 0 || rank > 511 - 7 || rank % 8 != 0;
            // Shifted by whole root tiles, so that windows that stick out of the lattice keep the order.
            ranks.push_back({leaf_key({x + leaf - 1 + at[0] + 512, y - 1 + at[1] + 512, z - 1 + at[2] + 512}), rank});
          }
          wrong += !in_order(ranks);
        }
        for (int reach = 1; reach <= 3; ++reach) {
          const auto large = site_order::large_order({x, y, z}, reach);
          const int span = 2 * reach + 1;
          for (int leaf = 0; leaf < 8; ++leaf) {
            std::vector<std::pair<uint64_t, int64_t>> ranks;
            for (int i = 0; i < span * span * span; ++i) {
              const int at[3] = {leaf + i / span / span, i / span % span, i % span};
              int64_t rank = at[0] << 15 | at[1] << 12 | at[2] << 9;
              for (int axis = 0; axis < 3; ++axis) rank += at[axis] >= large.before[axis] ? large.side[axis] : 0;
              wrong += rank >> site_order::kLargeBits != 0;
              ranks.push_back(
                  {leaf_key({x - reach + at[0] + 512, y - reach + at[1] + 512, z - reach + at[2] + 512}), rank});
            }
            wrong += !in_order(ranks);
          }
        }
      }
  CHECK(wrong == 0);
}
