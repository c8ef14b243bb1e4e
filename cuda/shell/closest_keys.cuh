// Keys of two voxels that are neighbours along z, and how the passes of the distance transform lower them. A key is a
// squared distance above digits of site_order.h; the smallest is the closest site.
#pragma once

#include "cuda/runtime/warp.cuh"
#include "cuda/shell/site_order.h"
#include "voxel/leaf.h"

namespace isoshell {
namespace closest {

constexpr uint32_t kBoth = 0x00010001u;

/// min(a + b, c) by halves; no half may overflow.
__device__ inline uint32_t add_min_pair(uint32_t a, uint32_t b, uint32_t c) { return __viaddmin_u16x2(a, b, c); }

/// Keys of 16 bits, two to a word, for bands up to 9: seven bits of squared distance above nine of order. Of a site's
/// digits the passes keep those that decide: of the y pass, leaf and y; of the x pass, leaf and x.
struct SmallPair {
  static constexpr int kMaxBand = 9;
  static constexpr int kBits = 9;
  static constexpr int kPlaneWords = 36;  ///< 32 words and padding against bank conflicts
  static constexpr int kSites = 64;       ///< leaves' digits
  using Pair = uint32_t;
  struct Order {
    uint32_t digits[3][3];     ///< by axis, leaf of the window
    uint32_t shift_z, jump_z;  ///< for fix_z; both 0 where there is no border
  };

  __device__ static void set_order(Voxel row, int, bool over_border, Order& o) {
    if (site_order::is_mixed(row)) return set_mixed_order(row, over_border, o);
    for (int at = 0; at < 3; ++at) {
      o.digits[0][at] = uint32_t(72 * at);
      o.digits[1][at] = uint32_t(24 * at);
      o.digits[2][at] = uint32_t(8 * at);
    }
    o.shift_z = o.jump_z = 0;
  }
  __device__ __noinline__ static void set_mixed_order(Voxel row, bool over_border, Order& o) {
    const site_order::SmallOrder small = site_order::small_order(row, over_border);
    for (int axis = 0; axis < 3; ++axis)
      for (int at = 0; at < 3; ++at) o.digits[axis][at] = uint32_t(small.leaf(axis, at));
    o.shift_z = small.before[2] == 1 ? 8 * kBoth : 0;
    o.jump_z = uint32_t(small.jump[2]);
  }
  __device__ static uint32_t none(int band) { return uint32_t(band * band + 1) << kBits; }
  __device__ static Pair no_pair(int band) { return none(band) * kBoth; }
  /// Keys from a site `steps` below z, or above z + 1.
  __device__ static Pair from_below(const Order& o, int z, int steps, int most, int band) {
    const uint32_t leaf = o.digits[2][max(z - steps, 0) >> 3];  // a site farther than most has no leaf
    return key(steps, leaf, most, band) | key(steps + 1, leaf, most, band) << 16;
  }
  __device__ static Pair from_above(const Order& o, int z, int steps, int most, int band) {
    const uint32_t leaf = o.digits[2][min(z + 1 + steps, 23) >> 3];
    return key(steps + 1, leaf, most, band) | key(steps, leaf, most, band) << 16;
  }
  __device__ static uint32_t key(int steps, uint32_t digits, int most, int band) {
    return steps <= most ? (uint32_t(steps * steps) << kBits) + digits : none(band);
  }
  /// Table values count the leaves along z without the border.
  __device__ static Pair fix_z(const Order& o, Pair v) { return v + ((v + o.shift_z) >> 4 & kBoth) * o.jump_z; }
  __device__ static uint32_t row_code(const Order& o, int leaf, int y) {
    return (o.digits[1][leaf] + uint32_t(y)) * kBoth;
  }
  __device__ static uint32_t plane_code(const Order& o, int leaf, int, int x) {
    return (o.digits[0][leaf] + uint32_t(x)) * kBoth;
  }
  __device__ static Pair add_row(Pair v, uint32_t code) { return v + code; }
  __device__ static Pair add_plane(Pair v, uint32_t code) { return (v & ~(7 * kBoth)) + code; }
  /// What a step across the rows or planes adds.
  __device__ static uint32_t cost(int distance_sq) { return (uint32_t(distance_sq) << kBits) * kBoth; }
  __device__ static Pair lower(Pair v, uint32_t cost, Pair best) { return add_min_pair(v, cost, best); }
  /// Keys that are too large for a step of this cost fit it, and stay too large.
  __device__ static Pair at_most(Pair v, int distance_sq) { return __vminu2(v, cost(127 - distance_sq)); }
  __device__ static bool fits(int distance_sq, int band) { return band * band + 1 + distance_sq <= 127; }
  __device__ static Pair smaller(Pair a, Pair b) { return __vminu2(a, b); }
  __device__ static uint32_t first(Pair v) { return v & 0xffff; }
  __device__ static uint32_t second(Pair v) { return v >> 16; }
};

/// Keys of 32 bits for any band: all digits of a site below ten bits of squared distance (at most 2 * 401).
struct LargePair {
  static constexpr int kPlaneWords = 72;
  static constexpr int kSites = 1;
  static constexpr int kBits = site_order::kLargeBits;
  struct alignas(8) Pair {
    uint32_t lo, hi;
  };
  using Order = site_order::LargeOrder;

  __device__ static void set_order(Voxel row, int reach, bool, Order& o) { o = site_order::large_order(row, reach); }
  __device__ static uint32_t none(int band) { return uint32_t(band * band + 1) << kBits; }
  __device__ static Pair no_pair(int band) { return {none(band), none(band)}; }
  __device__ static uint32_t digits_z(const Order& o, int place) {
    return uint32_t((place >> 3) << 9 | (place & 7)) + ((place >> 3) >= o.before[2] ? o.side[2] : 0);
  }
  /// Keys from a site `steps` below z, or above z + 1.
  __device__ static Pair from_below(const Order& o, int z, int steps, int most, int band) {
    const uint32_t digits = digits_z(o, z - steps);
    return {key(steps, digits, most, band), key(steps + 1, digits, most, band)};
  }
  __device__ static Pair from_above(const Order& o, int z, int steps, int most, int band) {
    const uint32_t digits = digits_z(o, z + 1 + steps);
    return {key(steps + 1, digits, most, band), key(steps, digits, most, band)};
  }
  __device__ static uint32_t key(int steps, uint32_t digits, int most, int band) {
    return steps <= most ? (uint32_t(steps * steps) << kBits) + digits : none(band);
  }
  __device__ static uint32_t row_code(const Order& o, int leaf, int y) {
    return uint32_t(leaf << 12 | y << 3) + (leaf >= o.before[1] ? o.side[1] : 0);
  }
  __device__ static uint32_t plane_code(const Order& o, int, int place_in_row, int x) {
    return uint32_t(place_in_row << 15 | x << 6) + (place_in_row >= o.before[0] ? o.side[0] : 0);
  }
  __device__ static Pair add_row(Pair v, uint32_t code) { return {v.lo + code, v.hi + code}; }
  __device__ static Pair add_plane(Pair v, uint32_t code) { return {v.lo + code, v.hi + code}; }
  __device__ static uint32_t cost(int distance_sq) { return uint32_t(distance_sq) << kBits; }
  __device__ static Pair lower(Pair v, uint32_t cost, Pair best) {
    return {min(v.lo + cost, best.lo), min(v.hi + cost, best.hi)};
  }
  __device__ static Pair smaller(Pair a, Pair b) { return {min(a.lo, b.lo), min(a.hi, b.hi)}; }
  __device__ static uint32_t first(Pair v) { return v.lo; }
  __device__ static uint32_t second(Pair v) { return v.hi; }
};

}  // namespace closest
}  // namespace isoshell
