// Points in a uniform grid (paper section 3.2), and exact searches in it: rings of cells around a box, until no cell
// that is left can hold anything closer. The order of points within a cell is free; no result may depend on it.
#pragma once

#include <cstdint>

#include "isoshell/advanced/voxel_set.h"
#include "voxel/exact_int.h"

namespace isoshell {

/// A point as the grid keeps it: its place and its number in the array the grid was made from.
struct GridPoint {
  PointQ8 position;
  uint32_t id;
};

struct PointGridView {
  int32_t shift;                    ///< edge of a cell is 1 << shift in q8
  int32_t dims[3];                  ///< cells per axis
  View<const uint32_t> cell_first;  ///< cell_count + 1 offsets into points; cells are x-major
  View<const GridPoint> points;
};

/// Inclusive box in q8.
struct BoxQ8 {
  PointQ8 lo, hi;
};

ISOSHELL_HD inline int32_t grid_coordinate(const PointGridView& grid, int32_t q8, int axis) {
  const int32_t c = q8 >> grid.shift;
  return c < 0 ? 0 : c < grid.dims[axis] ? c : grid.dims[axis] - 1;
}
ISOSHELL_HD inline int64_t grid_cell(const PointGridView& grid, int32_t cx, int32_t cy, int32_t cz) {
  return (int64_t(cx) * grid.dims[1] + cy) * grid.dims[2] + cz;
}
ISOSHELL_HD inline int64_t grid_cell_of(const PointGridView& grid, PointQ8 p) {
  return grid_cell(grid, grid_coordinate(grid, p.x, 0), grid_coordinate(grid, p.y, 1), grid_coordinate(grid, p.z, 2));
}

/// Calls visit(const GridPoint&) for the points of the cells cz_lo..cz_hi of one row; they lie together.
template <class Visit>
ISOSHELL_HD inline void visit_row(const PointGridView& grid, int32_t cx, int32_t cy, int32_t cz_lo, int32_t cz_hi,
                                  Visit& visit) {
  const int64_t first = grid_cell(grid, cx, cy, cz_lo);
  const uint32_t end = grid.cell_first[first + (cz_hi - cz_lo) + 1];
  for (uint32_t i = grid.cell_first[first]; i < end; ++i) visit(grid.points[i]);
}

/// Calls visit(const GridPoint&) for the points of the cells that meet the box.
template <class Visit>
ISOSHELL_HD inline void visit_box(const PointGridView& grid, const BoxQ8& box, Visit& visit) {
  const int32_t x_hi = grid_coordinate(grid, box.hi.x, 0), y_hi = grid_coordinate(grid, box.hi.y, 1),
                z_lo = grid_coordinate(grid, box.lo.z, 2), z_hi = grid_coordinate(grid, box.hi.z, 2);
  for (int32_t cx = grid_coordinate(grid, box.lo.x, 0); cx <= x_hi; ++cx)
    for (int32_t cy = grid_coordinate(grid, box.lo.y, 1); cy <= y_hi; ++cy) visit_row(grid, cx, cy, z_lo, z_hi, visit);
}

/// The cells at a distance of `ring` cells from those that meet a box: the surface of a block of cells, cut to the
/// grid.
struct CellRing {
  static constexpr int64_t kNothingBeyond = int64_t(1) << 40;

  int32_t lo[3], hi[3];    ///< cells that meet the box
  int32_t from[3], to[3];  ///< the block
  int32_t ring;
  int64_t gap = kNothingBeyond;  ///< points in cells beyond the ring are farther from the box on some axis, in q8

  ISOSHELL_HD CellRing(const PointGridView& grid, const BoxQ8& box, int32_t number) : ring(number) {
    const int32_t box_lo[3] = {box.lo.x, box.lo.y, box.lo.z}, box_hi[3] = {box.hi.x, box.hi.y, box.hi.z};
    for (int axis = 0; axis < 3; ++axis) {
      lo[axis] = grid_coordinate(grid, box_lo[axis], axis);
      hi[axis] = grid_coordinate(grid, box_hi[axis], axis);
      from[axis] = lo[axis] - ring;
      to[axis] = hi[axis] + ring;
      if (from[axis] <= 0)
        from[axis] = 0;
      else
        come_closer(int64_t(box_lo[axis]) - (int64_t(from[axis]) << grid.shift));
      if (to[axis] >= grid.dims[axis] - 1)
        to[axis] = grid.dims[axis] - 1;
      else
        come_closer((int64_t(to[axis] + 1) << grid.shift) - 1 - box_hi[axis]);
    }
  }

  /// Whether no point beyond the ring is at most at this squared distance.
  ISOSHELL_HD bool reaches(int64_t bound_q16) const {
    return gap == kNothingBeyond || (gap >= 0 && gap * gap >= bound_q16);
  }
  /// Calls visit(const GridPoint&) for the points in the ring's cells of row (cx, cy) of the block.
  template <class Visit>
  ISOSHELL_HD void visit_in_row(const PointGridView& grid, int32_t cx, int32_t cy, Visit& visit) const {
    const bool inner = ring > 0 && cx > lo[0] - ring && cx < hi[0] + ring && cy > lo[1] - ring && cy < hi[1] + ring;
    if (!inner) {
      visit_row(grid, cx, cy, from[2], to[2], visit);
      return;
    }
    if (lo[2] - ring >= 0) visit_row(grid, cx, cy, lo[2] - ring, lo[2] - ring, visit);
    if (hi[2] + ring < grid.dims[2]) visit_row(grid, cx, cy, hi[2] + ring, hi[2] + ring, visit);
  }

 private:
  ISOSHELL_HD void come_closer(int64_t to_border) { gap = to_border < gap ? to_border : gap; }
};

/// Calls visit(const GridPoint&) outwards from the box until every point at squared distance <= visit.bound_q16() of it
/// was visited; the bound may fall on the way, and points that are farther may be visited too.
template <class Visit>
ISOSHELL_HD inline void visit_around(const PointGridView& grid, const BoxQ8& box, Visit& visit) {
  for (int32_t number = 0;; ++number) {
    const CellRing ring(grid, box, number);
    for (int32_t cx = ring.from[0]; cx <= ring.to[0]; ++cx)
      for (int32_t cy = ring.from[1]; cy <= ring.to[1]; ++cy) ring.visit_in_row(grid, cx, cy, visit);
    if (ring.reaches(visit.bound_q16())) return;
  }
}

/// Keeps the smallest (squared distance, id) of the points it is shown.
struct NearestPoint {
  PointQ8 from;
  int64_t distance_sq_q16 = int64_t(1) << 62;
  uint32_t id = kNone;

  ISOSHELL_HD int64_t bound_q16() const { return distance_sq_q16; }
  ISOSHELL_HD void operator()(const GridPoint& p) {
    const int64_t d = isoshell::distance_sq_q16(from, p.position);
    if (d > distance_sq_q16 || (d == distance_sq_q16 && p.id > id)) return;
    distance_sq_q16 = d;
    id = p.id;
  }
};

/// The point with the smallest (squared distance, id), exact; kNone from an empty grid.
ISOSHELL_HD inline NearestPoint nearest_point(const PointGridView& grid, PointQ8 from) {
  NearestPoint nearest{from};
  visit_around(grid, BoxQ8{from, from}, nearest);
  return nearest;
}

}  // namespace isoshell
