// Which points can be the nearest one of some voxel in a cube of a leaf: gathered once a leaf, then again and again for
// smaller cubes of it among those that are left, so that a voxel compares a handful of them. Exact: a point stays out
// only when another is nearer, or as near with a smaller id, at every voxel of the cube.
#pragma once

#include "voxel/leaf.h"
#include "voxel/point_grid.h"

namespace isoshell {

constexpr int kMaxNear = 256;  ///< points of a list

/// A cube of voxels in a leaf and its active ones.
struct LeafCube {
  int edge, x, y, z;  ///< in voxels; the smallest voxel by its offsets in the leaf
  uint64_t row[8];    ///< active voxels of slice x + i, i < edge; bits are those of the leaf

  ISOSHELL_HD bool empty() const {
    uint64_t any = 0;
    for (int i = 0; i < edge; ++i) any |= row[i];
    return any == 0;
  }
};

ISOSHELL_HD inline LeafCube cube_of_leaf(const LeafMask& mask, int edge, int x, int y, int z) {
  LeafCube block{edge, x, y, z, {}};
  const uint64_t line = ((uint64_t(1) << edge) - 1) << z;
  uint64_t square = 0;
  for (int i = y; i < y + edge; ++i) square |= line << (8 * i);
  for (int i = 0; i < edge; ++i) block.row[i] = mask.word[x + i] & square;
  return block;
}

/// One of the eight halves along each axis.
ISOSHELL_HD inline LeafCube octant_of(const LeafMask& mask, const LeafCube& cube, int number) {
  const int half = cube.edge / 2;
  return cube_of_leaf(mask, half, cube.x + (number >> 2) * half, cube.y + (number >> 1 & 1) * half,
                      cube.z + (number & 1) * half);
}

/// Tight box of the centres of the cube's active voxels, from the centre of the leaf's voxel 0. Not for an empty cube.
ISOSHELL_HD inline BoxQ8 box_of_centres(const LeafCube& cube) {
  int x_lo = 8, x_hi = 0, y_lo = 8, y_hi = 0;
  uint64_t all = 0;
  for (int i = 0; i < cube.edge; ++i)
    if (cube.row[i]) {
      x_lo = x_lo < 8 ? x_lo : cube.x + i;
      x_hi = cube.x + i;
      all |= cube.row[i];
    }
  uint32_t line = 0;
  for (int y = 0; y < 8; ++y)
    if (const uint32_t here = uint32_t(all >> (8 * y)) & 255) {
      y_lo = y_lo < 8 ? y_lo : y;
      y_hi = y;
      line |= here;
    }
  const int z_lo = lowest_bit(line);
  int z_hi = z_lo;
  for (int z = z_lo; z < 8; ++z) z_hi = line >> z & 1 ? z : z_hi;
  return {{x_lo * kOneVoxelQ8, y_lo * kOneVoxelQ8, z_lo * kOneVoxelQ8},
          {x_hi * kOneVoxelQ8, y_hi * kOneVoxelQ8, z_hi * kOneVoxelQ8}};
}

/// Points by their places from the centre of a leaf's voxel 0.
struct PointList {
  int count = 0;  ///< above kMaxNear: they do not fit
  int32_t x[kMaxNear], y[kMaxNear], z[kMaxNear];
  uint32_t id[kMaxNear];
  int32_t number[kMaxNear];  ///< place in the list that was gathered, which this one was chosen from

  ISOSHELL_HD void add(Vec64 place, uint32_t its_id) {
    if (count < kMaxNear) {
      x[count] = int32_t(place.x), y[count] = int32_t(place.y), z[count] = int32_t(place.z);
      id[count] = its_id;
      number[count] = count;
    }
    ++count;
  }
  ISOSHELL_HD void set(int to, const PointList& from, int i) {
    x[to] = from.x[i], y[to] = from.y[i], z[to] = from.z[i];
    id[to] = from.id[i];
    number[to] = from.number[i];
  }
  ISOSHELL_HD Vec64 place(int i) const { return {x[i], y[i], z[i]}; }

  /// Squared distances between voxels of the leaf and points within 64 voxels on each axis fit 32 bits, and what is
  /// made of them here does.
  ISOSHELL_HD bool is_narrow() const {
    constexpr int32_t kLimit = 64 * kOneVoxelQ8;
    uint32_t bits = 0;
    for (int i = 0; i < count; ++i) bits |= uint32_t(x[i] + kLimit) | uint32_t(y[i] + kLimit) | uint32_t(z[i] + kLimit);
    return bits < 2 * kLimit;
  }
};

/// Points of `from` that can be the nearest one somewhere in the box: those that the one of the smallest greatest
/// distance does not beat everywhere. The difference of two squared distances is linear, so its largest value is that
/// of a corner. Equal distances go to the smaller id.
template <class T>
ISOSHELL_HD inline void keep_winnable(const PointList& from, const BoxQ8& box, PointList& to) {
  const auto farther_end = [](int32_t lo, int32_t hi, int32_t p) { return T(p - lo > hi - p ? p - lo : hi - p); };
  T measure[kMaxNear];
  for (int i = 0; i < from.count; ++i) {
    const T x = farther_end(box.lo.x, box.hi.x, from.x[i]), y = farther_end(box.lo.y, box.hi.y, from.y[i]),
            z = farther_end(box.lo.z, box.hi.z, from.z[i]);
    measure[i] = x * x + y * y + z * z;
  }
  T least = measure[0];
  for (int i = 1; i < from.count; ++i) least = measure[i] < least ? measure[i] : least;
  int best = 0;
  while (measure[best] != least) ++best;
  const int32_t best_x = from.x[best], best_y = from.y[best], best_z = from.z[best];
  const uint32_t best_id = from.id[best];
  const auto most = [](int32_t lo, int32_t hi, int32_t best_p, int32_t p) {
    return T(p - best_p) * T(2 * (p > best_p ? hi : lo) - p - best_p);
  };
  for (int i = 0; i < from.count; ++i)
    measure[i] = most(box.lo.x, box.hi.x, best_x, from.x[i]) + most(box.lo.y, box.hi.y, best_y, from.y[i]) +
                 most(box.lo.z, box.hi.z, best_z, from.z[i]) + (from.id[i] <= best_id ? 1 : 0);
  int32_t kept[kMaxNear];
  to.count = 0;
  for (int i = 0; i < from.count; ++i) {
    kept[to.count] = i;
    to.count += measure[i] > 0;
  }
  for (int i = 0; i < to.count; ++i) to.set(i, from, kept[i]);
}

/// The same points by ascending id.
ISOSHELL_HD inline void sort_by_id(const PointList& from, PointList& to) {
  int32_t place[kMaxNear];
  for (int i = 0; i < from.count; ++i) place[i] = 0;
  for (int j = 0; j < from.count; ++j)
    for (int i = 0; i < from.count; ++i) place[i] += from.id[j] < from.id[i] ? 1 : 0;
  for (int i = 0; i < from.count; ++i) to.set(place[i], from, i);
  to.count = from.count;
}

/// Gathers the points that are within reach of a box on every axis: those that the nearest one of a voxel is among
/// while it is no farther than that. The box is from `origin`, the centre of the leaf's voxel 0.
ISOSHELL_HD inline void gather_near(const PointGridView& grid, PointQ8 origin, const BoxQ8& box, int32_t reach_q8,
                                    PointList& out) {
  const PointQ8 lo = {origin.x + box.lo.x - reach_q8, origin.y + box.lo.y - reach_q8, origin.z + box.lo.z - reach_q8},
                hi = {origin.x + box.hi.x + reach_q8, origin.y + box.hi.y + reach_q8, origin.z + box.hi.z + reach_q8};
  out.count = 0;
  const auto add = [&](const GridPoint& p) {
    const PointQ8 at = p.position;
    if (at.x >= lo.x && at.x <= hi.x && at.y >= lo.y && at.y <= hi.y && at.z >= lo.z && at.z <= hi.z)
      out.add(difference(at, origin), p.id);
  };
  visit_box(grid, {lo, hi}, add);
}

}  // namespace isoshell
