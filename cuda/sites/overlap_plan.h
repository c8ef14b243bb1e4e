// The exact overlap test of voxel/overlap.h, prepared once for a triangle in a window of at most 128 voxels a side, so
// that every test inside needs additions of small integers only.
//
// In units of voxels relative to the window, each of the nine shadow sides is p P + q Q + s (p^+ + q^+) + k >= 0 and
// the plane is n . c + s n^+ + low >= 0, n . c - s n^- - high <= 0, for the cube of side s at c. The same numbers serve
// voxels (s = 1) and leaves (s = 8), because everything but k, low and high is a whole number of voxels.
#pragma once

#include "voxel/overlap.h"

namespace isoshell {
namespace overlap_plan {

constexpr int kWindow = 128;

/// A side of a shadow for voxels, s = 1, with p^+ + q^+ in k; with p = q = 0 it holds everywhere (k = 0) or nowhere
/// (k = -1).
struct Side {
  int32_t p, q, k;

  ISOSHELL_HD int32_t value(int32_t at_p, int32_t at_q) const { return p * at_p + q * at_q + k; }
  ISOSHELL_HD int32_t value_of_leaf(int32_t at_p, int32_t at_q) const {
    return value(at_p, at_q) + 7 * ((p > 0 ? p : 0) + (q > 0 ? q : 0));
  }
};

/// Axes of the three shadows.
ISOSHELL_HD constexpr int first_axis(int shadow) { return shadow == 2 ? 1 : 0; }
ISOSHELL_HD constexpr int second_axis(int shadow) { return shadow == 0 ? 1 : 2; }

struct Plan {
  int32_t base[3];          ///< the window's lowest voxel
  uint8_t last[3];          ///< highest voxel of the triangle's bounding range in the window, relative to base
  uint8_t narrow;           ///< not 0 when plane values in leaves that the triangle meets fit 32 bits
  Side side[3][3];          ///< by shadow: xy, xz, yz
  int32_t normal[3][2];     ///< 64-bit numbers in halves, so that plans can lie an odd number of words apart; z >= 0
  int32_t low[2], high[2];  ///< for voxels
};
static_assert(sizeof(Plan) % 8 == 4, "plans of neighbouring lanes must start in different banks");

ISOSHELL_HD inline int64_t joined(const int32_t halves[2]) {
  return int64_t(uint64_t(uint32_t(halves[0])) | uint64_t(uint32_t(halves[1])) << 32);
}
ISOSHELL_HD inline void split(int64_t value, int32_t halves[2]) {
  halves[0] = int32_t(uint64_t(value));
  halves[1] = int32_t(uint64_t(value) >> 32);
}

/// Folds sides that hold everywhere or nowhere near the window; what is left fits 32 bits.
ISOSHELL_HD inline Side side_of(int64_t p, int64_t q, int64_t k) {
  const int64_t reach = kWindow + 8, positive = positive_part(p) + positive_part(q);
  const int64_t spread = (p < 0 ? -p : p) * reach + (q < 0 ? -q : q) * reach;
  if (k - spread >= 0) return {0, 0, 0};
  if (k + spread + 8 * positive < 0) return {0, 0, -1};
  return {int32_t(p), int32_t(q), int32_t(k + positive)};
}
/// Of a triangle that fits half a window.
ISOSHELL_HD inline Side side_of(int32_t p, int32_t q, int32_t k) {
  return {p, q, k + (p > 0 ? p : 0) + (q > 0 ? q : 0)};
}

template <class Int>
ISOSHELL_HD inline void plan_shadow(const TriangleQ8& t, int p, int q, const int32_t base[3], Side side[3]) {
  const Int area = Int(t.at[1][p] - t.at[0][p]) * (t.at[2][q] - t.at[0][q]) -
                   Int(t.at[1][q] - t.at[0][q]) * (t.at[2][p] - t.at[0][p]);
  const Int sign = area < 0 ? -1 : 1;
  Int longest = -1, lp = 0, lq = 0, ld = 0;
  for (int from = 0; from < 3; ++from) {
    const int to = from == 2 ? 0 : from + 1;
    const Int np = sign * (t.at[from][q] - t.at[to][q]), nq = sign * (t.at[to][p] - t.at[from][p]);
    const Int d = np * (t.at[from][p] - base[p] * kOneVoxelQ8) + nq * (t.at[from][q] - base[q] * kOneVoxelQ8);
    side[from] = side_of(np, nq, Int(-d >> kFractionBits));
    const Int length = (np < 0 ? -np : np) + (nq < 0 ? -nq : nq);
    if (length > longest) longest = length, lp = np, lq = nq, ld = d;
  }
  if (area != 0) return;
  // A triangle seen from its edge is a segment: both sides of its longest edge.
  side[0] = side_of(lp, lq, Int(-ld >> kFractionBits));
  side[1] = side_of(Int(-lp), Int(-lq), Int(ld >> kFractionBits));
  side[2] = {0, 0, 0};
}

ISOSHELL_HD inline void plan_plane(const Vec64& n, int64_t low, int64_t high, Plan& plan) {
  split(n.x, plan.normal[0]);
  split(n.y, plan.normal[1]);
  split(n.z, plan.normal[2]);
  split(low + positive_part(n.x) + positive_part(n.y) + n.z, plan.low);
  split(high + positive_part(-n.x) + positive_part(-n.y), plan.high);
  const int64_t size = positive_part(n.x) + positive_part(-n.x) + positive_part(n.y) + positive_part(-n.y) + n.z;
  // In a leaf that the plane meets, values are at most eight times that from 0, and a step further at the end of a
  // loop.
  plan.narrow = size < (int64_t(1) << 31) / 10;
}

/// A plan for the part of a triangle in a range of at most kWindow voxels; false when the range is empty.
ISOSHELL_HD inline bool make_plan(const TriangleQ8& t, const CellRange& range, Plan& plan) {
  if (is_empty(range)) return false;
  for (int axis = 0; axis < 3; ++axis) {
    plan.base[axis] = range.lo[axis];
    plan.last[axis] = uint8_t(range.hi[axis] - range.lo[axis]);
  }
  for (int shadow = 0; shadow < 3; ++shadow)
    plan_shadow<int64_t>(t, first_axis(shadow), second_axis(shadow), plan.base, plan.side[shadow]);
  Vec64 n = triangle_normal(t);
  if (n.z < 0) n = n * -1;
  __int128 height = 0;
  height += __int128(n.x) * (t.at[0][0] - int64_t(plan.base[0]) * kOneVoxelQ8);
  height += __int128(n.y) * (t.at[0][1] - int64_t(plan.base[1]) * kOneVoxelQ8);
  height += __int128(n.z) * (t.at[0][2] - int64_t(plan.base[2]) * kOneVoxelQ8);
  plan_plane(n, int64_t(-height >> kFractionBits), int64_t(height >> kFractionBits), plan);
  return true;
}

/// Largest difference of the ends of a bounding range, in voxels, of a triangle that a small plan takes: its edges are
/// below 2^14, areas of its shadows below 2^28, and all products of the shadows fit 32 bits.
constexpr int32_t kSmallSpan = 62;

/// The same for a whole small triangle; `range` is its bounding range.
ISOSHELL_HD inline void make_small_plan(const TriangleQ8& t, const CellRange& range, Plan& plan) {
  for (int axis = 0; axis < 3; ++axis) {
    plan.base[axis] = range.lo[axis];
    plan.last[axis] = uint8_t(range.hi[axis] - range.lo[axis]);
  }
  for (int shadow = 0; shadow < 3; ++shadow)
    plan_shadow<int32_t>(t, first_axis(shadow), second_axis(shadow), plan.base, plan.side[shadow]);
  const int32_t ax = t.at[1][0] - t.at[0][0], ay = t.at[1][1] - t.at[0][1], az = t.at[1][2] - t.at[0][2];
  const int32_t bx = t.at[2][0] - t.at[0][0], by = t.at[2][1] - t.at[0][1], bz = t.at[2][2] - t.at[0][2];
  int32_t nx = ay * bz - az * by, ny = az * bx - ax * bz, nz = ax * by - ay * bx;
  if (nz < 0) nx = -nx, ny = -ny, nz = -nz;
  const int64_t height = int64_t(nx) * (t.at[0][0] - plan.base[0] * kOneVoxelQ8) +
                         int64_t(ny) * (t.at[0][1] - plan.base[1] * kOneVoxelQ8) +
                         int64_t(nz) * (t.at[0][2] - plan.base[2] * kOneVoxelQ8);
  plan_plane({nx, ny, nz}, -height >> kFractionBits, height >> kFractionBits, plan);
}

/// Plane values at a voxel: the triangle's plane meets it if and only if low >= 0 and high <= 0.
struct PlaneValues {
  int64_t low, high;
};
ISOSHELL_HD inline PlaneValues plane_at(const Plan& plan, int32_t x, int32_t y, int32_t z) {
  const int64_t at = joined(plan.normal[0]) * x + joined(plan.normal[1]) * y + joined(plan.normal[2]) * z;
  return {at + joined(plan.low), at - joined(plan.high)};
}

/// Does the triangle meet the leaf whose lowest voxel is (x, y, z)? The leaf must meet the bounding range.
ISOSHELL_HD inline bool meets_leaf(const Plan& plan, int32_t x, int32_t y, int32_t z) {
  int32_t all = 0;
  for (int i = 0; i < 3; ++i)
    all |=
        plan.side[0][i].value_of_leaf(x, y) | plan.side[1][i].value_of_leaf(x, z) | plan.side[2][i].value_of_leaf(y, z);
  if (all < 0) return false;
  const int64_t nx = joined(plan.normal[0]), ny = joined(plan.normal[1]), nz = joined(plan.normal[2]);
  const PlaneValues plane = plane_at(plan, x, y, z);
  return plane.low + 7 * (positive_part(nx) + positive_part(ny) + nz) >= 0 &&
         plane.high - 7 * (positive_part(-nx) + positive_part(-ny)) <= 0;
}

/// Shifts in the sign of a number.
ISOSHELL_HD inline uint32_t with_sign(uint32_t bits, int32_t value) {
#if defined(__CUDA_ARCH__)
  return __funnelshift_l(uint32_t(value), bits, 1);
#else
  return bits << 1 | uint32_t(value) >> 31;
#endif
}

/// Bits q of 0..7 where the shadow holds for voxel faces (at_p, at_q + q).
ISOSHELL_HD inline uint32_t shadow_row(const Side side[3], int32_t at_p, int32_t at_q) {
  int32_t a = side[0].value(at_p, at_q + 7), b = side[1].value(at_p, at_q + 7), c = side[2].value(at_p, at_q + 7);
  uint32_t outside = 0;
  for (int q = 7; q >= 0; --q, a -= side[0].q, b -= side[1].q, c -= side[2].q) outside = with_sign(outside, a | b | c);
  return ~outside & 0xffu;
}

/// Bits z of 0..7 where the plane meets the voxels of a column; values at z = 0.
ISOSHELL_HD inline uint32_t plane_column(int32_t low, int32_t high, int32_t step) {
  low += 7 * step;
  int32_t above = -(high + 7 * step);
  uint32_t outside = 0;
  for (int z = 7; z >= 0; --z, low -= step, above += step) outside = with_sign(outside, low | above);
  return ~outside & 0xffu;
}
ISOSHELL_HD inline uint32_t plane_column(int64_t low, int64_t high, int64_t step) {
  low += 7 * step;
  int64_t above = -(high + 7 * step);
  uint32_t outside = 0;
  for (int z = 7; z >= 0; --z, low -= step, above += step) outside = with_sign(outside, int32_t((low | above) >> 32));
  return ~outside & 0xffu;
}

/// Widest bounding range, in voxels, of a whole triangle's plan whose plane values fit 32 bits all over it and whose
/// columns fit 16.
constexpr int32_t kTinyWidth = 16;
ISOSHELL_HD inline bool is_tiny(const Plan& plan) {
  return plan.last[0] < kTinyWidth && plan.last[1] < kTinyWidth && plan.last[2] < kTinyWidth;
}

/// Bits z from the window's lowest voxel up where a tiny plan's triangle meets the voxels of column (x, y).
ISOSHELL_HD inline uint32_t column_bits(const Plan& plan, int32_t x, int32_t y) {
  const Side(&xy)[3] = plan.side[0], (&xz)[3] = plan.side[1], (&yz)[3] = plan.side[2];
  if ((xy[0].value(x, y) | xy[1].value(x, y) | xy[2].value(x, y)) < 0) return 0;
  const int32_t last = plan.last[2], nz = plan.normal[2][0];
  int32_t a = xz[0].value(x, last), b = xz[1].value(x, last), c = xz[2].value(x, last);
  int32_t d = yz[0].value(y, last), e = yz[1].value(y, last), f = yz[2].value(y, last);
  const int32_t at = plan.normal[0][0] * x + plan.normal[1][0] * y + nz * last;
  int32_t low = at + plan.low[0], above = plan.high[0] - at;
  uint32_t outside = 0;
  for (int32_t z = last; z >= 0; --z) {
    outside = with_sign(outside, (a | b | c) | (d | e | f) | (low | above));
    a -= xz[0].q, b -= xz[1].q, c -= xz[2].q;
    d -= yz[0].q, e -= yz[1].q, f -= yz[2].q;
    low -= nz, above += nz;
  }
  return ~outside & ((2u << last) - 1);
}

/// Bits lo..hi, clamped to 0..7.
ISOSHELL_HD inline uint32_t range_bits(int lo, int hi) {
  lo = lo < 0 ? 0 : lo;
  hi = hi > 7 ? 7 : hi;
  return lo > hi ? 0 : (2u << hi) - (1u << lo);
}

}  // namespace overlap_plan
}  // namespace isoshell
