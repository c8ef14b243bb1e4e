// Triangles between three cells, many at a time: SplitTriangle::three_cells of voxel/cell_sum.h in lanes.
#pragma once

#include "cpu/relax/cut_arithmetic.h"

namespace isoshell {

/// Triangles whose corners lie in three cells, one of which has the whole triangle so far, and what each cell gains.
struct ThreeCellSimd {
  static constexpr int kLanes = 8;  ///< as a block has few of them; all are worked on
  using Corner = LocalLanes<kLanes>;

  int count = 0;  ///< lanes that are used
  // By corners. Those of a triangle may be turned in its lane, with all that belongs to them.
  Corner corner[3]{}, seed[3]{};
  uint32_t cell[3][kLanes];
  int32_t has_all[3][kLanes]{};  ///< 1: the cell that has the triangle so far
  int64_t mass[3][kLanes], first_x[3][kLanes], first_y[3][kLanes], first_z[3][kLanes], second[3][kLanes];
  uint32_t area2[kLanes]{};

  PieceSum gained(int k, int i) const {
    return {mass[k][i], first_x[k][i], first_y[k][i], first_z[k][i], second[k][i]};
  }

  /// Finds what is gained.
  void split();
};

}  // namespace isoshell
