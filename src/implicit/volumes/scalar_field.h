// A sparse scalar field on an integer lattice, whatever file it came from: blocks of 8^3 values and tiles of one value.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "isoshell/advanced/lattice.h"

namespace isoshell {

constexpr int32_t kFieldBlock = 8;        ///< voxels along a block
constexpr int32_t kFieldReach = 1 << 30;  ///< no block lies farther from the origin
constexpr int kWindow = kFieldBlock + 1;  ///< a block and the first voxels of the next ones
constexpr int kWindowStride[3] = {kWindow * kWindow, kWindow, 1};

/// A cube of lattice points that all have one value.
struct FieldTile {
  Voxel origin;
  int32_t size;  ///< points along an edge, a multiple of kFieldBlock
  float value;
};

/// Index coordinates to the world: world[i] = at[i][0] x + at[i][1] y + at[i][2] z + at[i][3].
struct AffineMap {
  double at[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
};

/// Of a lattice by its steps along its axes.
inline AffineMap lattice_map(const std::array<WorldPoint, 3>& step, const WorldPoint& origin) {
  const auto& [x, y, z] = step;
  return {{{x.x, y.x, z.x, origin.x}, {x.y, y.y, z.y, origin.y}, {x.z, y.z, z.z, origin.z}}};
}

/// Whether all of it is finite and it has an inverse.
inline bool is_invertible(const AffineMap& map) {
  const auto& m = map.at;
  const double det = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                     m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                     m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  bool finite = std::isfinite(det) && det != 0;
  for (const auto& row : m)
    for (const double value : row) finite = finite && std::isfinite(value);
  return finite;
}

/// Length of a voxel's edges, 0 where they differ or are not square to each other.
inline double cube_edge(const AffineMap& map) {
  constexpr double kSlack = 0.01;
  double dot[3][3] = {};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (const auto& row : map.at) dot[i][j] += row[i] * row[j];
  const double sq = dot[0][0];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (std::abs(dot[i][j] - (i == j ? sq : 0)) > 2 * kSlack * sq) return 0;
  return std::sqrt(sq);
}

/// Beyond them nothing is known of a field, and its surface ends there.
struct FieldSides {
  Voxel first, last;        ///< the outermost lattice points
  bool are_closed = true;   ///< by faces in the planes of these points
  bool are_halved = false;  ///< the outermost cells are half as thick as others
  double off_points = 0;    ///< in cells: how far crossings on edges with an end on any side stay from their ends

  bool hold(Voxel v) const {
    return v.x >= first.x && v.y >= first.y && v.z >= first.z && v.x <= last.x && v.y <= last.y && v.z <= last.z;
  }
  /// Whether all corners of the cell behind its smallest one are held.
  bool hold_cell(Voxel v) const { return hold(v) && v.x < last.x && v.y < last.y && v.z < last.z; }
  /// Whether a lattice point lies in the plane of a side.
  bool have_in_plane(Voxel v) const {
    return v.x == first.x || v.y == first.y || v.z == first.z || v.x == last.x || v.y == last.y || v.z == last.z;
  }
  /// Where the surface passes the edge from a lattice point along an axis, as a part of that edge: as far from its ends
  /// as off_points says.
  double kept_off_points(Voxel from, int axis, double part) const {
    const Voxel to{from.x + (axis == 0), from.y + (axis == 1), from.z + (axis == 2)};
    return have_in_plane(from) || have_in_plane(to) ? std::clamp(part, off_points, 1 - off_points) : part;
  }
  bool hold_block(Voxel origin) const {
    return hold(origin) && hold({origin.x + kFieldBlock, origin.y + kFieldBlock, origin.z + kFieldBlock});
  }
  /// Where a point of the lattice is, whose outermost cells may be halved.
  WorldPoint halved(const WorldPoint& p) const {
    const auto along = [](double x, int32_t low, int32_t high) {
      return x < low + 1 ? .5 * (x + low + 1) : x > high - 1 ? .5 * (x + high - 1) : x;
    };
    if (!are_halved) return p;
    return {along(p.x, first.x, last.x), along(p.y, first.y, last.y), along(p.z, first.z, last.z)};
  }
};

class ScalarField {
 public:
  virtual ~ScalarField() = default;

  /// Smallest corners of the blocks that hold values, in any order.
  virtual std::vector<Voxel> blocks() const = 0;
  /// Tiles, in any order; where there is neither block nor tile the field has the value of the background.
  virtual std::vector<FieldTile> tiles() const = 0;
  /// The first size[i] values along each axis of the block at `origin`, or of the tile there, at kWindowStride. NaN
  /// where nothing is known.
  virtual void copy(Voxel origin, const int size[3], float* to) const = 0;
  /// The same field, but going on beyond its sides as it came to them, for what looks at its slopes; null without
  /// sides.
  virtual std::unique_ptr<ScalarField> continued() const { return nullptr; }

  /// A level set whose background is 0: it says nothing of what lies beyond the band, where a value that nobody set is
  /// not known.
  bool is_band_alone() const { return background == 0 && grid_class == "level set"; }

  std::string title() const { return file + ": grid \"" + name + "\""; }

  std::string file, name, grid_class;
  double background = 0;
  AffineMap to_world;
  std::optional<FieldSides> sides;
  double most_rise = 0;         ///< from a point to the next; where values differ by more they jump; 0: not looked at
  bool opens_at_jumps = false;  ///< the surface is not known there
};

/// Copies from an array of 512 values, z fastest, `value(i)` giving the i-th.
template <class Value>
void copy_block(const int size[3], float* to, Value value) {
  for (int x = 0; x < size[0]; ++x)
    for (int y = 0; y < size[1]; ++y)
      for (int z = 0; z < size[2]; ++z)
        to[x * kWindowStride[0] + y * kWindowStride[1] + z] = float(value(x * 64 + y * 8 + z));
}

}  // namespace isoshell
