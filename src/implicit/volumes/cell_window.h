// The cells of a block of a field: its lattice points and the first ones of the next blocks, at kWindowStride.
#pragma once

#include <algorithm>
#include <cmath>

#include "implicit/volumes/iso_cases.h"
#include "implicit/volumes/scalar_field.h"

namespace isoshell {

constexpr double kEdgeEnd = 1.0 / 4096;  ///< vertices keep that far from the ends of their edges, so none coincide

/// The same beside creases and where these are kept: fixed points of a lattice as fine as the field's keep them apart.
constexpr double kCreaseEdgeEnd = 1.0 / 64;

/// Which values lie inside the surface.
struct Inside {
  double iso;
  bool below;
  double margin = 0;  ///< values that are not this much inside of the surface count as outside
  double limit() const { return below ? iso - margin : iso + margin; }
  bool operator()(double value) const { return below ? value < limit() : value > limit(); }
};

/// The side of a value that the background does not lie on; below it where only the band of a level set is known.
inline Inside inside_of(const ScalarField& field, double iso) {
  const bool is_at_background = field.background == iso && field.grid_class == "level set";
  return {iso, field.is_band_alone() || is_at_background || field.background > iso};
}

inline Voxel plus(Voxel a, int32_t x, int32_t y, int32_t z) { return {a.x + x, a.y + y, a.z + z}; }

/// The block `step` lattice points away along each axis of the corner's bits.
inline Voxel block_beside(Voxel block, int corner, int32_t step) {
  return plus(block, corner >> 2 ? step : 0, corner >> 1 & 1 ? step : 0, corner & 1 ? step : 0);
}

inline int window_index(int offset) {
  return (offset >> 6) * kWindowStride[0] + (offset >> 3 & 7) * kWindowStride[1] + (offset & 7);
}

inline void read_cell_window(const ScalarField& field, Voxel block, float* window) {
  for (int n = 0; n < 8; ++n) {
    const int size[3] = {n >> 2 ? 1 : 8, n >> 1 & 1 ? 1 : 8, n & 1 ? 1 : 8};
    const int at = (n >> 2) * 8 * kWindowStride[0] + (n >> 1 & 1) * 8 * kWindowStride[1] + (n & 1) * 8;
    field.copy(block_beside(block, n, kFieldBlock), size, window + at);
  }
}

/// The value at a corner of a cell of a window.
inline float at_corner(const float* cell, int corner) {
  return cell[window_index((corner >> 2) << 6 | (corner >> 1 & 1) << 3 | (corner & 1))];
}

/// Whether a value of a cell is not known.
inline bool has_unknown(const float* cell) {
  for (int c = 0; c < 8; ++c)
    if (std::isnan(at_corner(cell, c))) return true;
  return false;
}

/// Whether the known values of a cell lie on both sides of the surface.
inline bool has_both_sides(const float* cell, Inside is_inside) {
  bool inside = false, outside = false;
  for (int c = 0; c < 8; ++c)
    if (const float value = at_corner(cell, c); !std::isnan(value)) (is_inside(value) ? inside : outside) = true;
  return inside && outside;
}

/// Which points of a window lie inside: 1, others 0.
struct InsidePoints {
  uint8_t at[kWindow * kWindow * kWindow];

  InsidePoints(const float* window, Inside is_inside) {
    const double limit = is_inside.limit();
    // One comparison a loop: then several points are looked at at once.
    if (is_inside.below)
      for (int i = 0; i < kWindow * kWindow * kWindow; ++i) at[i] = window[i] < limit;
    else
      for (int i = 0; i < kWindow * kWindow * kWindow; ++i) at[i] = window[i] > limit;
  }
};

/// Calls visit(offset of the cell in its block, corner of the window, bits of the corners inside) for the cells that
/// the surface crosses.
template <class Visit>
void each_cut_cell(const float* window, const InsidePoints& points, Visit visit) {
  for (int row = 0; row < 64; ++row) {
    const int first = window_index(row << 3);
    const uint8_t* at = points.at + first;
    uint8_t four[kWindow];  // bits of the corners with the same z
    for (int z = 0; z < kWindow; ++z)
      four[z] = uint8_t(at[z] | at[z + kWindow] << 2 | at[z + kWindowStride[0]] << 4 |
                        at[z + kWindowStride[0] + kWindow] << 6);
    for (int z = 0; z < 8; ++z) {
      const int inside = four[z] | four[z + 1] << 1;
      if (inside != 0 && inside != 255) visit(row << 3 | z, window + first + z, inside);
    }
  }
}
template <class Visit>
void each_cut_cell(const float* window, Inside is_inside, Visit visit) {
  each_cut_cell(window, InsidePoints(window, is_inside), visit);
}

inline double finite_value(float value) { return std::clamp<double>(value, -3e38, 3e38); }

/// Where an edge crosses the surface between two values: 0 at its first end, 1 at the other.
inline double crossing_on_edge(float first, float second, double iso) {
  const double from = finite_value(first), to = finite_value(second);
  return std::clamp((iso - from) / (to - from), kEdgeEnd, 1 - kEdgeEnd);
}

}  // namespace isoshell
