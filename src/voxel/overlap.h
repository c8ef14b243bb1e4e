// Which cells does a triangle occupy? Exact, in integers: a closed triangle against the closed cubes of a regular grid.
//
// Separating axes decide: three box normals, the triangle's plane, nine edge cross products. The latter are the edge
// normals of the triangle's three axis-parallel shadows, so a cell is occupied if and only if it lies in the bounding
// range, its three faces meet the three shadows, and it straddles the plane. Every one of these is an inequality that
// is linear in the cell's integer coordinates; along a column the occupied cells are therefore one run, found by
// division instead of by testing cells. Triangles without area have no plane, and shadows that are segments or points;
// the same test with both sides of each shadow edge is then exact as well.
//
// Budget, coordinates < 2^22 (lattice 8192 + 2 * 32 voxels in q8, at most 2^21.02): edges < 2^22, normal < 2^45 (in
// fact at most the squared lattice side, 2^42.1), normal times cell index < 2^56. Only normal . corner may need 3 *
// 2^63.1, so that one sum is 128 bits wide; divided by the cell's side it is below 2^57.
#pragma once

#include <cstdint>

#include "isoshell/advanced/lattice.h"
#include "isoshell/advanced/voxel_set.h"
#include "voxel/exact_int.h"

namespace isoshell {

constexpr int kVoxelShift = kFractionBits;      ///< cells are voxels
constexpr int kLeafShift = kFractionBits + 3;   ///< cells are leaves
constexpr int kBlockShift = kFractionBits + 7;  ///< cells are blocks of 16^3 leaves

/// Corners by [corner][axis], in q8.
struct TriangleQ8 {
  int32_t at[3][3];
};
ISOSHELL_HD inline TriangleQ8 triangle_q8(PointQ8 a, PointQ8 b, PointQ8 c) {
  return {{{a.x, a.y, a.z}, {b.x, b.y, b.z}, {c.x, c.y, c.z}}};
}

/// Cells lo..hi, both included; empty when lo > hi on some axis.
struct CellRange {
  int32_t lo[3], hi[3];
};

/// Consecutive cells along one axis; empty when lo > hi.
struct CellRun {
  int32_t lo, hi;
};

/// One side of a shadow, p P + q Q + k >= 0 over cell coordinates, ready to be solved for Q: floor((p P + k) / size) is
/// an upper bound of Q where q < 0, and the lower bound's negative where q > 0.
struct ShadowSide {
  int64_t p, k, size;
  bool bounds_below;
};
ISOSHELL_HD inline ShadowSide shadow_side(int64_t p, int64_t q, int64_t k) {
  // Without Q, the bound is beyond every cell where the side holds, and -1 or less where it does not.
  if (q == 0) return {p * 32768, k * 32768 + 0x7fff, 1, false};
  return {p, k, q < 0 ? -q : q, q > 0};
}

/// A triangle seen along an axis: cell face (P, Q) meets it if and only if every side holds and the face lies in the
/// bounding range.
struct TriangleShadow {
  ShadowSide side[6];
  int count;

  /// Cells Q in 0..last of a row.
  ISOSHELL_HD CellRun row(int32_t row, int32_t last) const {
    int64_t lo = 0, hi = last;
    for (int i = 0; i < count; ++i) {
      const ShadowSide& s = side[i];
      const int64_t bound = floor_div(s.k + s.p * row, s.size);
      const int64_t below = s.bounds_below ? -bound : 0, above = s.bounds_below ? last : bound;
      lo = below > lo ? below : lo;
      hi = above < hi ? above : hi;
    }
    if (lo > hi) return {1, 0};
    return {int32_t(lo), int32_t(hi)};
  }
};

ISOSHELL_HD inline int64_t positive_part(int64_t x) { return x > 0 ? x : 0; }

/// Shadow on axes (p, q). `base` is the cell that gets coordinates (0, 0).
ISOSHELL_HD inline TriangleShadow shadow_of(const TriangleQ8& t, int p, int q, const int32_t base[3], int shift) {
  TriangleShadow shadow;
  shadow.count = 0;
  const int64_t ep = t.at[1][p] - t.at[0][p], eq = t.at[1][q] - t.at[0][q];
  const int64_t fp = t.at[2][p] - t.at[0][p], fq = t.at[2][q] - t.at[0][q];
  const int64_t area = ep * fq - eq * fp;
  for (int from = 0; from < 3; ++from) {
    const int to = from == 2 ? 0 : from + 1;
    const int64_t np = t.at[from][q] - t.at[to][q], nq = t.at[to][p] - t.at[from][p];
    if (np == 0 && nq == 0) continue;
    const int64_t rp = t.at[from][p] - (int64_t(base[p]) << shift), rq = t.at[from][q] - (int64_t(base[q]) << shift);
    // The cell's corner farthest along the normal must not be outside the edge; divided by the cell's side.
    const auto add = [&](int64_t mp, int64_t mq) {
      const int64_t k = positive_part(mp) + positive_part(mq) + (-(mp * rp + mq * rq) >> shift);
      shadow.side[shadow.count++] = shadow_side(mp, mq, k);
    };
    if (area >= 0) add(np, nq);
    if (area <= 0) add(-np, -nq);
  }
  return shadow;
}

/// Cells that the triangle's bounding box meets.
ISOSHELL_HD inline CellRange bounding_range(const TriangleQ8& t, int shift) {
  CellRange r;
  for (int axis = 0; axis < 3; ++axis) {
    const int32_t a = t.at[0][axis], b = t.at[1][axis], c = t.at[2][axis];
    const int32_t ab_lo = a < b ? a : b, ab_hi = a < b ? b : a;
    r.lo[axis] = ((ab_lo < c ? ab_lo : c) - 1) >> shift;
    r.hi[axis] = (ab_hi > c ? ab_hi : c) >> shift;
  }
  return r;
}
ISOSHELL_HD inline CellRange common_range(const CellRange& a, const CellRange& b) {
  CellRange r;
  for (int axis = 0; axis < 3; ++axis) {
    r.lo[axis] = a.lo[axis] > b.lo[axis] ? a.lo[axis] : b.lo[axis];
    r.hi[axis] = a.hi[axis] < b.hi[axis] ? a.hi[axis] : b.hi[axis];
  }
  return r;
}
ISOSHELL_HD inline bool is_empty(const CellRange& r) {
  return r.lo[0] > r.hi[0] || r.lo[1] > r.hi[1] || r.lo[2] > r.hi[2];
}
/// The axis along which a range is a single row, or -1. A triangle that fits into one row meets all its cells.
ISOSHELL_HD inline int axis_of_row(const CellRange& r) {
  const bool x = r.lo[0] == r.hi[0], y = r.lo[1] == r.hi[1], z = r.lo[2] == r.hi[2];
  return x && y ? 2 : x && z ? 1 : y && z ? 0 : -1;
}

/// The triangle's plane as a function of columns: floor division carried from one column to the next without dividing.
struct PlaneWalk {
  int64_t step, side, low, low_rest, high, high_rest;

  /// Columns step by `step`, |step| <= side. Cells k of the column: low_value + side k >= 0 and high_value + side k <=
  /// 0.
  ISOSHELL_HD void start(int64_t low_value, int64_t high_value) {
    low = floor_div(low_value, side);
    low_rest = low_value - low * side;
    high = floor_div(-high_value, side);
    high_rest = -high_value - high * side;
  }
  ISOSHELL_HD CellRun run(int32_t lo, int32_t hi) const {
    const int64_t first = -low > lo ? -low : lo, last = high < hi ? high : hi;
    if (first > last) return {1, 0};
    return {int32_t(first), int32_t(last)};
  }
  ISOSHELL_HD void next() {
    low_rest += step;
    high_rest -= step;
    if (low_rest >= side) low_rest -= side, ++low;
    if (low_rest < 0) low_rest += side, --low;
    if (high_rest >= side) high_rest -= side, ++high;
    if (high_rest < 0) high_rest += side, --high;
  }
};

/// The plane in cell coordinates relative to a base cell: normal . cell + low >= 0 and normal . cell + high <= 0.
struct TrianglePlane {
  int64_t normal[3], low, high;
};

/// Turned so that the component along `axis` is not negative.
ISOSHELL_HD inline TrianglePlane plane_of(const TriangleQ8& t, Vec64 n, int axis, const int32_t base[3], int shift) {
  TrianglePlane plane = {{n.x, n.y, n.z}, 0, 0};
  const bool turn = plane.normal[axis] < 0;
  __int128 height = 0;
  for (int i = 0; i < 3; ++i) {
    if (turn) plane.normal[i] = -plane.normal[i];
    height += __int128(plane.normal[i]) * (t.at[0][i] - (int64_t(base[i]) << shift));
    plane.low += positive_part(plane.normal[i]);
    plane.high -= positive_part(-plane.normal[i]);
  }
  plane.low += int64_t(-height >> shift);
  plane.high -= int64_t(height >> shift);
  return plane;
}

ISOSHELL_HD inline Vec64 triangle_normal(const TriangleQ8& t) {
  const Vec64 ab = {t.at[1][0] - t.at[0][0], t.at[1][1] - t.at[0][1], t.at[1][2] - t.at[0][2]};
  const Vec64 ac = {t.at[2][0] - t.at[0][0], t.at[2][1] - t.at[0][1], t.at[2][2] - t.at[0][2]};
  return cross(ab, ac);
}

/// Axis of the largest magnitude, the lowest in a tie.
ISOSHELL_HD inline int largest_axis(int64_t x, int64_t y, int64_t z) {
  const int64_t ax = x < 0 ? -x : x, ay = y < 0 ? -y : y, az = z < 0 ? -z : z;
  if (ax >= ay && ax >= az) return 0;
  return ay >= az ? 1 : 2;
}

/// Calls visit(axis, first, count) for runs of cells along `axis` that together are exactly the cells of `clip` that
/// meet the triangle, each once; `first` is the run's lowest cell. A cell is a cube of side 2^shift. `clip` may be at
/// most kSpan cells wide. Cost: a few divisions a row, none a column.
template <int kSpan, class Visit>
ISOSHELL_HD inline void for_each_run(const TriangleQ8& t, const CellRange& clip, int shift, Visit visit) {
  const CellRange box = bounding_range(t, shift), range = common_range(box, clip);
  if (is_empty(range)) return;
  const int row = axis_of_row(box);
  if (row >= 0) {
    visit(row, Voxel{range.lo[0], range.lo[1], range.lo[2]}, range.hi[row] - range.lo[row] + 1);
    return;
  }
  const Vec64 n = triangle_normal(t);
  const int32_t span[3] = {range.hi[0] - range.lo[0], range.hi[1] - range.lo[1], range.hi[2] - range.lo[2]};
  const bool flat = n.x == 0 && n.y == 0 && n.z == 0;
  const int w = flat ? largest_axis(span[0], span[1], span[2]) : largest_axis(n.x, n.y, n.z);
  const int u = w == 2 ? 0 : w + 1, v = u == 2 ? 0 : u + 1;
  const TriangleShadow on_uv = shadow_of(t, u, v, range.lo, shift), on_uw = shadow_of(t, u, w, range.lo, shift),
                       on_vw = shadow_of(t, v, w, range.lo, shift);
  const TrianglePlane plane = plane_of(t, n, w, range.lo, shift);
  CellRun along_v[kSpan];
  for (int32_t j = 0; j <= span[v]; ++j) along_v[j] = on_vw.row(j, span[w]);
  for (int32_t i = 0; i <= span[u]; ++i) {
    const CellRun columns = on_uv.row(i, span[v]), along_u = on_uw.row(i, span[w]);
    if (columns.lo > columns.hi || along_u.lo > along_u.hi) continue;
    PlaneWalk walk = {plane.normal[v], plane.normal[w], 0, 0, span[w], 0};
    const int64_t at_row = plane.normal[u] * i + plane.normal[v] * columns.lo;
    if (!flat) walk.start(plane.low + at_row, plane.high + at_row);
    for (int32_t j = columns.lo; j <= columns.hi; ++j) {
      const int32_t lo = along_u.lo > along_v[j].lo ? along_u.lo : along_v[j].lo;
      const int32_t hi = along_u.hi < along_v[j].hi ? along_u.hi : along_v[j].hi;
      const CellRun run = walk.run(lo, hi);
      if (!flat) walk.next();
      if (run.lo > run.hi) continue;
      int32_t first[3];
      first[u] = range.lo[u] + i;
      first[v] = range.lo[v] + j;
      first[w] = range.lo[w] + run.lo;
      visit(w, Voxel{first[0], first[1], first[2]}, run.hi - run.lo + 1);
    }
  }
}

/// Calls visit(cell) for every cell of `clip` that meets the triangle.
template <int kSpan, class Visit>
ISOSHELL_HD inline void for_each_cell(const TriangleQ8& t, const CellRange& clip, int shift, Visit visit) {
  for_each_run<kSpan>(t, clip, shift, [&](int axis, Voxel cell, int32_t count) {
    for (int32_t i = 0; i < count; ++i) {
      visit(cell);
      (axis == 0 ? cell.x : axis == 1 ? cell.y : cell.z) += 1;
    }
  });
}

/// Leaf coordinates of a block's leaves.
ISOSHELL_HD inline CellRange leaves_of_block(Voxel block) {
  return {{block.x * 16, block.y * 16, block.z * 16}, {block.x * 16 + 15, block.y * 16 + 15, block.z * 16 + 15}};
}

/// Turns on the voxels of the leaf that meet the triangle.
ISOSHELL_HD inline void mark_voxels(const TriangleQ8& t, Voxel leaf, LeafMask& mask) {
  const CellRange clip = {{leaf.x * 8, leaf.y * 8, leaf.z * 8}, {leaf.x * 8 + 7, leaf.y * 8 + 7, leaf.z * 8 + 7}};
  for_each_run<8>(t, clip, kVoxelShift, [&](int axis, Voxel first, int32_t count) {
    const int word = first.x & 7, bit = (first.y & 7) << 3 | (first.z & 7);
    if (axis == 0) {
      for (int32_t i = 0; i < count; ++i) mask.word[word + i] |= uint64_t(1) << bit;
    } else if (axis == 1) {
      mask.word[word] |= (0x0101010101010101ull >> (64 - 8 * count)) << bit;
    } else {
      mask.word[word] |= ((uint64_t(1) << count) - 1) << bit;
    }
  });
}

}  // namespace isoshell
