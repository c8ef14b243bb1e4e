// The order of site ids around a leaf, as numbers that add up axis by axis: what the closest-site kernel puts below the
// squared distance of a key, so that the smallest key is the smallest (squared distance, site id).
//
// Sites are ordered by leaf, then by offset. Leaves of one block of 16^3 follow each other in the order of (x, y, z); a
// window of leaves may reach into a second block along each axis. Which side of such a border a leaf lies on counts
// more than its coordinates in the block: first the borders that are borders of root tiles, too, then the others, each
// by axis. So a leaf's rank is a number whose digits are those sides, then its coordinates in the window.
#pragma once

#include <cstdint>

#include "isoshell/advanced/lattice.h"

namespace isoshell {
namespace site_order {

/// The kernel works on eight leaves in a row along x that start at a multiple of 8, so its window always reaches over
/// one border of blocks along x: the one at its start or the one at its end.
constexpr int kRowLeaves = 8;

/// Number of window leaves along an axis that lie before the border, the window starting at leaf `from`.
ISOSHELL_HD inline int before_border(int32_t from, int span) {
  const int left = 16 - (from & 15);
  return left < span ? left : span;
}

/// Values of the three border digits: rank of each axis among them, 0 the least.
struct BorderRanks {
  int rank[3];
};
ISOSHELL_HD inline BorderRanks border_ranks(const int32_t from[3], const int before[3]) {
  BorderRanks out;
  int weight[3];
  for (int axis = 0; axis < 3; ++axis) {
    const bool root = ((from[axis] + before[axis]) & 511) == 0;
    weight[axis] = (root ? 4 : 0) + 2 - axis;
  }
  for (int axis = 0; axis < 3; ++axis) {
    int rank = 0;
    for (int other = 0; other < 3; ++other) rank += weight[other] < weight[axis];
    out.rank[axis] = rank;
  }
  return out;
}

/// Mixed-radix ranks for windows of three leaves, sized to fit nine bits with a digit of 8 below: along each axis
/// `step` a leaf and `jump` more behind the border. A border along x that lies in the window of one leaf of the row
/// only counts where there are others, and then only for that leaf: an order is for the leaves whose windows it is in,
/// or for all others.
struct SmallOrder {
  int before[3];  ///< leaves of the window before the border
  int step[3], jump[3];

  ISOSHELL_HD int leaf(int axis, int at) const { return at * step[axis] + (at >= before[axis] ? jump[axis] : 0); }
};
/// Leaf of the row whose window reaches over a border along x.
ISOSHELL_HD inline int border_leaf(Voxel row) { return row.x & 8 ? kRowLeaves - 1 : 0; }
/// Whether that leaf needs an order of its own.
ISOSHELL_HD inline bool is_mixed(Voxel row) {
  return before_border(row.y - 1, 3) < 3 || before_border(row.z - 1, 3) < 3;
}

/// `row` holds the leaf coordinates of the row's first leaf.
ISOSHELL_HD inline SmallOrder small_order(Voxel row, bool over_border) {
  const int32_t from[3] = {row.x - 1 + border_leaf(row), row.y - 1, row.z - 1};
  SmallOrder o;
  for (int axis = 0; axis < 3; ++axis) o.before[axis] = before_border(from[axis], 3);
  const BorderRanks ranks = border_ranks(from, o.before);
  if (!over_border) o.before[0] = 3;
  int digit = 8;
  for (int axis = 2; axis >= 0; --axis) {
    o.step[axis] = digit;
    o.jump[axis] = 0;
    digit *= o.before[axis] < 3 ? 2 : 3;
  }
  for (int rank = 0; rank < 3; ++rank)
    for (int axis = 0; axis < 3; ++axis) {
      if (ranks.rank[axis] != rank || o.before[axis] == 3) continue;
      o.jump[axis] = digit - o.before[axis] * o.step[axis];
      digit *= 2;
    }
  return o;
}

/// Fixed digits for any window: three sides, leaf in the row's window (4 bits along x, 3 along y and z), voxel.
constexpr int kLargeBits = 22;
struct LargeOrder {
  int before[3];
  uint32_t side[3];
};
ISOSHELL_HD inline LargeOrder large_order(Voxel row, int reach) {
  const int32_t from[3] = {row.x - reach, row.y - reach, row.z - reach};
  LargeOrder o;
  o.before[0] = before_border(from[0], kRowLeaves + 2 * reach);
  o.before[1] = before_border(from[1], 2 * reach + 1);
  o.before[2] = before_border(from[2], 2 * reach + 1);
  const BorderRanks ranks = border_ranks(from, o.before);
  for (int axis = 0; axis < 3; ++axis) o.side[axis] = uint32_t(1) << (19 + ranks.rank[axis]);
  return o;
}

}  // namespace site_order
}  // namespace isoshell
