// Triangles between two cells, many at a time: SplitTriangle::two_cells of voxel/cell_sum.h in lanes.
#pragma once

#include "cpu/relax/cut_arithmetic.h"

namespace isoshell {

/// Triangles whose corner p lies in another cell than q and r, and the piece that each moves from one cell to another.
struct CutSimd {
  static constexpr int kLanes = 128;
  using Corner = LocalLanes<kLanes>;

  int count = 0;  ///< at most kLanes
  Corner p, q, r;
  Corner seed, other_seed;  ///< of p; of q and r
  uint32_t area2[kLanes];
  uint32_t all_is_at_p[kLanes];       ///< 1: the cell of p has the whole triangle so far; 0: the other one
  uint32_t from[kLanes], to[kLanes];  ///< cells that lose and gain
  int64_t mass[kLanes], first_x[kLanes], first_y[kLanes], first_z[kLanes], second[kLanes];  ///< what is moved

  PieceSum moved(int i) const { return {mass[i], first_x[i], first_y[i], first_z[i], second[i]}; }

  /// Finds what is moved.
  void cut();
};

}  // namespace isoshell
