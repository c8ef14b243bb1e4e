// The exact overlap of triangles and cells against clipping and against plain separating axes.
#include <algorithm>
#include <vector>

#include "oracle/overlap_oracle.h"
#include "support/catch.h"
#include "voxel/heap_sort.h"
#include "voxel/leaf.h"
#include "voxel/random.h"

using namespace isoshell;

namespace {

int32_t below(uint64_t seed, uint64_t index, int32_t bound) {
  return int32_t(random_bits(seed, index) % uint64_t(bound));
}

TriangleQ8 random_triangle(uint64_t seed, uint64_t index, int32_t base, int32_t bound) {
  TriangleQ8 t;
  for (int i = 0; i < 9; ++i) t.at[i / 3][i % 3] = base + below(seed, index * 9 + uint64_t(i), bound);
  return t;
}

/// Turns a triangle into a segment or a point now and then.
TriangleQ8 flatten(TriangleQ8 t, uint64_t kind) {
  for (int a = 0; a < 3; ++a) {
    if (kind == 1) t.at[2][a] = t.at[0][a];
    if (kind == 2) t.at[1][a] = t.at[2][a] = t.at[0][a];
    if (kind == 3) t.at[2][a] = t.at[0][a] + 2 * (t.at[1][a] - t.at[0][a]);
    if (kind == 4) t.at[a][1] = t.at[0][1];
  }
  return t;
}

int64_t cell_number(Voxel c, const CellRange& r) {
  return (int64_t(c.x - r.lo[0]) * (r.hi[1] - r.lo[1] + 1) + (c.y - r.lo[1])) * (r.hi[2] - r.lo[2] + 1) +
         (c.z - r.lo[2]);
}

/// Times that each cell of the range is visited.
std::vector<int> visits(const TriangleQ8& t, const CellRange& r, int shift) {
  std::vector<int> seen(size_t(cell_number({r.hi[0], r.hi[1], r.hi[2]}, r) + 1));
  for_each_cell<16>(t, r, shift, [&](Voxel c) { ++seen[size_t(cell_number(c, r))]; });
  return seen;
}

template <class Meets>
int64_t disagreements(const TriangleQ8& t, const CellRange& r, int shift, Meets meets) {
  const std::vector<int> seen = visits(t, r, shift);
  int64_t wrong = 0;
  for (int32_t x = r.lo[0]; x <= r.hi[0]; ++x)
    for (int32_t y = r.lo[1]; y <= r.hi[1]; ++y)
      for (int32_t z = r.lo[2]; z <= r.hi[2]; ++z)
        wrong += seen[size_t(cell_number({x, y, z}, r))] != (meets(t, Voxel{x, y, z}, shift) ? 1 : 0);
  return wrong;
}

}  // namespace

TEST_CASE("overlap: the walk visits exactly the cells that exact clipping finds, each once", "[overlap][unit]") {
  const CellRange grid = {{0, 0, 0}, {6, 6, 6}};
  int64_t wrong = 0;
  for (uint64_t i = 0; i < 1500; ++i) {
    const TriangleQ8 t = flatten(random_triangle(1, i, 4, 17), i % 8);
    wrong += disagreements(t, grid, 2, oracle::meets_by_clipping);
  }
  CHECK(wrong == 0);
}

TEST_CASE("overlap: triangles on cell boundaries occupy both sides", "[overlap][unit]") {
  const CellRange grid = {{0, 0, 0}, {6, 6, 6}};
  int64_t wrong = 0;
  for (uint64_t i = 0; i < 1500; ++i) {
    TriangleQ8 t = random_triangle(2, i, 1, 5);
    for (auto& p : t.at)
      for (int32_t& c : p) c *= 4;
    wrong += disagreements(flatten(t, i % 8), grid, 2, oracle::meets_by_clipping);
  }
  CHECK(wrong == 0);
  const std::vector<int> corner = visits(TriangleQ8{{{4, 4, 4}, {4, 4, 4}, {4, 4, 4}}}, {{0, 0, 0}, {2, 2, 2}}, 2);
  CHECK(std::count(corner.begin(), corner.end(), 1) == 8);
}

TEST_CASE("overlap: voxels of a large lattice agree with separating axes in 128 bits", "[overlap][unit]") {
  constexpr int32_t kLattice = (kMaxResolution + 2 * kMarginVox) * 256;
  int64_t wrong = 0, met = 0;
  for (uint64_t i = 0; i < 400; ++i) {
    const int32_t size = i % 4 == 0 ? kLattice - 4 : 1 << (8 + i % 13);
    TriangleQ8 t = flatten(random_triangle(3, i, 1, size), i % 16);
    for (auto& p : t.at)
      for (int32_t& c : p) c = std::min(std::max(c, 1), kLattice - 3) + (size < kLattice / 2 ? kLattice / 2 : 0);
    for (int shift : {kVoxelShift, kLeafShift, kBlockShift}) {
      // A window of cells around a point of the triangle, so that the border of the run is inside.
      CellRange window;
      for (int a = 0; a < 3; ++a) {
        const int64_t inside = (3 * int64_t(t.at[0][a]) + 4 * int64_t(t.at[1][a]) + int64_t(t.at[2][a])) / 8;
        window.lo[a] = int32_t(inside >> shift) - 2;
        window.hi[a] = window.lo[a] + 4;
      }
      wrong += disagreements(t, window, shift, oracle::meets_by_axes);
      for (int n : visits(t, window, shift)) met += n;
    }
  }
  CHECK(wrong == 0);
  CHECK(met > 1200);
}

TEST_CASE("overlap: both oracles agree", "[overlap][unit]") {
  int64_t wrong = 0;
  for (uint64_t i = 0; i < 20000; ++i) {
    const TriangleQ8 t = flatten(random_triangle(4, i, 0, 40), i % 8);
    const Voxel cell = {below(5, 3 * i, 5), below(5, 3 * i + 1, 5), below(5, 3 * i + 2, 5)};
    wrong += oracle::meets_by_clipping(t, cell, 3) != oracle::meets_by_axes(t, cell, 3);
  }
  CHECK(wrong == 0);
}

TEST_CASE("overlap: a leaf's mask holds the voxels that separating axes find", "[overlap][unit]") {
  int64_t wrong = 0;
  for (uint64_t i = 0; i < 400; ++i) {
    const TriangleQ8 t = flatten(random_triangle(6, i, 8000, 1 << (6 + i % 8)), i % 8);
    const Voxel leaf = {t.at[i % 3][0] >> kLeafShift, t.at[i % 3][1] >> kLeafShift, t.at[i % 3][2] >> kLeafShift};
    LeafMask mask = {};
    mark_voxels(t, leaf, mask);
    for (int offset = 0; offset < 512; ++offset)
      wrong += is_on(mask, offset) != oracle::meets_by_axes(t, voxel_at(leaf, offset), kVoxelShift);
  }
  CHECK(wrong == 0);
}

TEST_CASE("heap sort: short and long lists come out ascending", "[overlap][unit]") {
  for (int64_t count : {0, 1, 2, 48, 49, 50, 1000}) {
    std::vector<uint32_t> list, expect;
    for (int64_t i = 0; i < count; ++i) list.push_back(uint32_t(random_bits(7, uint64_t(i)) % 500));
    expect = list;
    std::sort(expect.begin(), expect.end());
    sort_ascending(list.data(), count);
    CHECK(list == expect);
  }
}
