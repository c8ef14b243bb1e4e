// The linear function nearest to the values of a cell: near a surface, the distances from a plane, or from none.
#pragma once

#include <cmath>

#include "implicit/volumes/cell_window.h"

namespace isoshell {

struct LinearFit {
  double mean, slope[3], rest_sq;

  /// How much it rises a voxel.
  double rise() const { return std::sqrt(slope[0] * slope[0] + slope[1] * slope[1] + slope[2] * slope[2]); }
  /// How far the cell's values are from a plane's distances, in parts of what these rise by a voxel.
  double bend(double usual_rise) const {
    const double off = rise() - usual_rise;
    return std::sqrt(rest_sq + off * off) / usual_rise;
  }
};

inline LinearFit fit_cell(const float* corner, const int stride[3]) {
  double v[8];
  for (int c = 0; c < 8; ++c)
    v[c] = finite_value(corner[(c >> 2) * stride[0] + (c >> 1 & 1) * stride[1] + (c & 1) * stride[2]]);
  // Sums and differences along each axis in turn leave the mean, the slopes and what is no linear function, each by
  // itself.
  for (int bit = 1; bit < 8; bit *= 2)
    for (int c = 0; c < 8; ++c) {
      if (c & bit) continue;
      const double low = v[c], high = v[c | bit];
      v[c] = (low + high) / 2;
      v[c | bit] = (high - low) / 2;
    }
  return {v[0], {2 * v[4], 2 * v[2], 2 * v[1]}, v[3] * v[3] + v[5] * v[5] + v[6] * v[6] + v[7] * v[7]};
}

}  // namespace isoshell
