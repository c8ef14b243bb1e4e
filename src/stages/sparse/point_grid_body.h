// Builds the grid of voxel/point_grid.h by counting.
#pragma once

#include "voxel/atomic.h"
#include "voxel/point_grid.h"

namespace isoshell {

/// Owner of a PointGridView. Made once for a lattice and a spacing, filled as often as the points move.
struct PointGrid {
  int32_t shift = 0;
  int32_t dims[3] = {};
  Buffer<uint32_t> cell_first;
  Buffer<GridPoint> points;

  PointGridView view() const { return {shift, {dims[0], dims[1], dims[2]}, cell_first.view(), points.view()}; }
};

struct CountGridPoint {
  PointGridView grid;
  View<const PointQ8> position;
  View<uint32_t> count;
  ISOSHELL_HD void operator()(int64_t i) const { atomic_add(count[grid_cell_of(grid, position[i])], uint32_t(1)); }
};

struct PlaceGridPoint {
  PointGridView grid;
  View<const PointQ8> position;
  View<uint32_t> cursor;
  View<GridPoint> points;
  ISOSHELL_HD void operator()(int64_t i) const {
    const PointQ8 p = position[i];
    points[atomic_take_one_below(cursor[grid_cell_of(grid, p)])] = {p, uint32_t(i)};
  }
};

/// Room for `count` points between 0 and `extent_vox`; others count as in its outermost cells. The edge of a cell is
/// the smallest power of two voxels that is at least `spacing_vox` and gives at most max(2^20, 32 count) cells.
template <class Exec>
PointGrid make_point_grid(Exec& exec, const int32_t extent_vox[3], int64_t spacing_vox, int64_t count) {
  PointGrid grid;
  const int64_t most = 32 * count > (1 << 20) ? 32 * count : 1 << 20;
  int64_t cells = 0;
  for (int32_t log2 = 0;; ++log2) {
    cells = 1;
    for (int axis = 0; axis < 3; ++axis) {
      const int32_t size = ((extent_vox[axis] - 1) >> log2) + 1;
      grid.dims[axis] = size;
      cells *= size;
    }
    grid.shift = kFractionBits + log2;
    if (int64_t(1) << log2 >= spacing_vox && cells <= most) break;
  }
  grid.cell_first = exec.template make<uint32_t>(cells + 1);
  grid.points = exec.template make<GridPoint>(count);
  return grid;
}

/// Sorts the points into their cells: each cell holds its end, which is counted down to its start.
template <class Exec>
void fill_point_grid(Exec& exec, PointGrid& grid, View<const PointQ8> position) {
  const View<uint32_t> cells = grid.cell_first.view();
  exec.fill(cells, uint32_t(0));
  exec.for_each("count seeds a cell", position.size, CountGridPoint{grid.view(), position, cells});
  exec.inclusive_scan(cells);
  exec.for_each("seeds into cells", position.size, PlaceGridPoint{grid.view(), position, cells, grid.points.view()});
}

}  // namespace isoshell
