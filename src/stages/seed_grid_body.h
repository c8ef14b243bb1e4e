// A uniform grid over the lattice that lists the seeds of each cell (paper section 3.2, the grid G).
#pragma once

#include "isoshell/seed_set.h"
#include "isoshell/sheet.h"
#include "voxel/atomic.h"
#include "voxel/exact_int.h"

namespace isoshell {

/// A seed as the grid lists it.
struct GridSeed {
  PointQ8 position;
  uint32_t id;
  Normal8 normal;
};

/// What a step sees of the grid. The order of the seeds inside a cell is not defined: use must not depend on it.
struct SeedGridView {
  int32_t dims[3];
  int32_t shift;                 ///< a cell is 2^shift q8 wide
  View<const uint32_t> first;    ///< cell_count + 1 offsets into seeds
  View<const GridSeed> seeds;

  ISOSHELL_HD int32_t cell_of(int32_t q8, int axis) const {
    const int32_t c = q8 >> shift;
    return c < 0 ? 0 : (c >= dims[axis] ? dims[axis] - 1 : c);
  }
  /// visit(seed) for every seed of the cells that meet the box.
  template <class Visit>
  ISOSHELL_HD void for_each_in(PointQ8 lo, PointQ8 hi, Visit visit) const {
    const int32_t x0 = cell_of(lo.x, 0), x1 = cell_of(hi.x, 0), y0 = cell_of(lo.y, 1), y1 = cell_of(hi.y, 1);
    const int32_t z0 = cell_of(lo.z, 2), z1 = cell_of(hi.z, 2);
    for (int32_t x = x0; x <= x1; ++x)
      for (int32_t y = y0; y <= y1; ++y) {
        const int64_t row = (int64_t(x) * dims[1] + y) * dims[2];
        for (uint32_t s = first[row + z0]; s < first[row + z1 + 1]; ++s) visit(seeds[s]);
      }
  }
};

namespace seed_grid {

struct CountSeed {
  SeedGridView grid;
  View<const PointQ8> position;
  View<uint32_t> count;
  ISOSHELL_HD int64_t cell(int64_t s) const {
    const PointQ8 p = position[s];
    return (int64_t(grid.cell_of(p.x, 0)) * grid.dims[1] + grid.cell_of(p.y, 1)) * grid.dims[2] + grid.cell_of(p.z, 2);
  }
  ISOSHELL_HD void operator()(int64_t s) const { atomic_add(count[cell(s)], 1u); }
};

struct PlaceSeed {
  CountSeed where;
  View<const Normal8> normal;
  View<GridSeed> out;
  ISOSHELL_HD void operator()(int64_t s) const {
    // `count` holds the end of each cell and is counted down to its start.
    const uint32_t at = atomic_take_one_below(where.count[where.cell(s)]);
    out[at] = {where.position[s], uint32_t(s), normal[s]};
  }
};

}  // namespace seed_grid

/// Owner of a SeedGridView.
struct SeedGrid {
  SeedGridView shape;
  Buffer<uint32_t> first;
  Buffer<GridSeed> seeds;

  SeedGridView view() const {
    SeedGridView v = shape;
    v.first = first.view();
    v.seeds = seeds.view();
    return v;
  }
};

/// Cells at least `spacing_q8` wide, doubled until there are at most max(2^18, 16 k) of them. Cost: O(cells + seeds).
template <class Exec>
SeedGrid build_seed_grid(Exec& exec, const int32_t extent_vox[3], const SeedSet& seeds, int64_t spacing_q8) {
  SeedGrid grid;
  SeedGridView& shape = grid.shape;
  const int64_t limit = seeds.size() * 16 > (1 << 18) ? seeds.size() * 16 : (1 << 18);
  shape.shift = kFractionBits;
  int64_t cells = 0;
  for (;; ++shape.shift) {
    for (int axis = 0; axis < 3; ++axis)
      shape.dims[axis] = int32_t(((int64_t(extent_vox[axis]) << kFractionBits) >> shape.shift) + 1);
    cells = int64_t(shape.dims[0]) * shape.dims[1] * shape.dims[2];
    if ((int64_t(1) << shape.shift) >= spacing_q8 && cells <= limit) break;
  }
  grid.first = exec.template make<uint32_t>(cells + 1);
  grid.seeds = exec.template make<GridSeed>(seeds.size());
  exec.fill(grid.first.view(), uint32_t(0));
  const seed_grid::CountSeed count{shape, seeds.position.view(), grid.first.view()};
  exec.for_each("count seeds in cells", seeds.size(), count);
  exec.inclusive_scan(grid.first.view());
  exec.for_each("list seeds of cells", seeds.size(), seed_grid::PlaceSeed{count, seeds.normal.view(), grid.seeds.view()});
  return grid;
}

}  // namespace isoshell
