// Triangles of a block, many at a time: their areas, and what their moments are made of.
#pragma once

#include "cpu/relax/cut_arithmetic.h"

namespace isoshell {

/// Triangles by lanes, about the block's centre. That a pass finds areas and moments anew costs less than what was
/// kept of every triangle and vertex would take: memory beside the largest lists of a run, and the way to it.
struct TriangleSimd {
  static constexpr int kLanes = 256;

  int count = 0;  ///< at most kLanes
  LocalLanes<kLanes> corner[3];
  uint32_t label[3][kLanes];
  uint32_t area2[kLanes];  ///< doubled
  LocalLanes<kLanes> sum;  ///< of the corners
  uint32_t squares[kLanes];

  PieceSum whole(int i) const {
    const int64_t a = area2[i];
    return {a, a * sum.x[i], a * sum.y[i], a * sum.z[i], a * squares[i]};
  }

  /// Finds what follows from the corners.
  void measure();
};

}  // namespace isoshell
