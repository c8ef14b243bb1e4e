// Keys of two voxels that are neighbours along z, and how the passes of the distance transform lower them. A key is a
// squared distance above digits of site_order.h; the smallest is the closest site.
#pragma once

#include "cuda/site_order.h"
#include "voxel/leaf.h"

namespace isoshell {
namespace closest {

constexpr unsigned kAllLanes = 0xffffffffu;
constexpr uint32_t kBoth = 0x00010001u;

/// min(a + b, c) by halves; no half may overflow.
__device__ inline uint32_t add_min_pair(uint32_t a, uint32_t b, uint32_t c) { return __viaddmin_u16x2(a, b, c); }

/// Places of the nearest sites in a row for the voxels at window place z and z + 1: `left` steps below z, `right` steps
/// above z + 1; band + 1 where there is none.
struct Nearest {
  int z, left, right;
};

/// Squared distances only, two to a word: for finding which voxels are within the band.
struct DistancePair {
  static constexpr bool kValues = false;
  static constexpr int kPlaneWords = 36;  ///< 32 words and padding against bank conflicts
  static constexpr int kDecoderEntries = 1;
  static constexpr int kBits = 0;
  using Pair = uint32_t;
  struct Order {};

  __device__ static Order order(Voxel, int) { return {}; }
  __device__ static uint32_t none(int band) { return uint32_t(band * band + 1); }
  __device__ static Pair no_pair(int band) { return none(band) * kBoth; }
  __device__ static Pair along_z(const Order&, Nearest n) {
    const int lo = min(n.left, n.right + 1), hi = min(n.left + 1, n.right);
    return uint32_t(lo * lo) | uint32_t(hi * hi) << 16;
  }
  __device__ static uint32_t row_code(const Order&, int, int) { return 0; }
  __device__ static uint32_t plane_code(const Order&, int, int, int) { return 0; }
  __device__ static Pair add_row(Pair v, uint32_t) { return v; }
  __device__ static Pair add_plane(Pair v, uint32_t) { return v; }
  /// What a step across the rows or planes adds.
  __device__ static uint32_t cost(int distance_sq) { return uint32_t(distance_sq) * kBoth; }
  __device__ static Pair lower(Pair v, uint32_t cost, Pair best) { return add_min_pair(v, cost, best); }
  __device__ static uint32_t first(Pair v) { return v & 0xffff; }
  __device__ static uint32_t second(Pair v) { return v >> 16; }
};

/// Keys of 16 bits, two to a word, for bands up to 5: six bits of squared distance (at most 2 * 26) above ten of order.
/// Of a site's digits the passes keep those that decide: of the y pass, leaf and y; of the x pass, leaf and x.
struct SmallPair : DistancePair {
  static constexpr bool kValues = true;
  static constexpr int kMaxBand = 5;
  static constexpr int kBits = 10;
  static constexpr int kDecoderEntries = 128;
  using Order = site_order::SmallOrder;

  __device__ static Order order(Voxel row, int) { return site_order::small_order(row); }
  __device__ static uint32_t none(int band) { return uint32_t(band * band + 1) << kBits; }
  __device__ static Pair no_pair(int band) { return none(band) * kBoth; }
  __device__ static uint32_t leaf_z(const Order& o, int place) {
    const int leaf = place >> 3;
    return uint32_t(o.leaf(2, leaf, leaf >= o.before[2]));
  }
  __device__ static Pair along_z(const Order& o, Nearest n) {
    const bool lo_left = n.left <= n.right + 1, hi_left = n.left + 1 <= n.right;
    const int lo = lo_left ? n.left : n.right + 1, hi = hi_left ? n.left + 1 : n.right;
    const int below = n.z - n.left, above = n.z + 1 + n.right;
    return (uint32_t(lo * lo) << kBits) + leaf_z(o, lo_left ? below : above) +
           (((uint32_t(hi * hi) << kBits) + leaf_z(o, hi_left ? below : above)) << 16);
  }
  /// Table values count the leaves along z without the border.
  __device__ static Pair fix_z(const Order& o, Pair v) {
    const uint32_t behind = (o.before[2] == 1 ? v + 8 * kBoth : v) >> 4 & kBoth;
    return v + behind * uint32_t(o.jump[2]);
  }
  __device__ static uint32_t row_code(const Order& o, int leaf, int y) {
    return uint32_t(o.leaf(1, leaf, leaf >= o.before[1]) + y) * kBoth;
  }
  __device__ static uint32_t plane_code(const Order& o, int leaf, int place_in_row, int x) {
    return uint32_t(o.leaf(0, leaf, place_in_row >= o.before[0]) + x) * kBoth;
  }
  __device__ static Pair add_row(Pair v, uint32_t code) { return v + code; }
  __device__ static Pair add_plane(Pair v, uint32_t code) { return (v & ~(7 * kBoth)) + code; }
  __device__ static uint32_t cost(int distance_sq) { return (uint32_t(distance_sq) << kBits) * kBoth; }
};

/// Keys of 32 bits for any band: all digits of a site below ten bits of squared distance (at most 2 * 401).
struct LargePair {
  static constexpr bool kValues = true;
  static constexpr int kPlaneWords = 72;
  static constexpr int kDecoderEntries = 1;
  static constexpr int kBits = site_order::kLargeBits;
  struct alignas(8) Pair {
    uint32_t lo, hi;
  };
  using Order = site_order::LargeOrder;

  __device__ static Order order(Voxel row, int reach) { return site_order::large_order(row, reach); }
  __device__ static uint32_t none(int band) { return uint32_t(band * band + 1) << kBits; }
  __device__ static Pair no_pair(int band) { return {none(band), none(band)}; }
  __device__ static uint32_t digits_z(const Order& o, int place) {
    return uint32_t((place >> 3) << 9 | (place & 7)) + ((place >> 3) >= o.before[2] ? o.side[2] : 0);
  }
  /// Keys from a site `steps` below z, or above z + 1.
  __device__ static Pair from_below(const Order& o, int z, int steps, int band) {
    const uint32_t digits = digits_z(o, z - steps);
    return {key(steps, digits, band), key(steps + 1, digits, band)};
  }
  __device__ static Pair from_above(const Order& o, int z, int steps, int band) {
    const uint32_t digits = digits_z(o, z + 1 + steps);
    return {key(steps + 1, digits, band), key(steps, digits, band)};
  }
  __device__ static uint32_t key(int steps, uint32_t digits, int band) {
    return steps <= band ? (uint32_t(steps * steps) << kBits) + digits : none(band);
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
  __device__ static uint32_t first(Pair v) { return v.lo; }
  __device__ static uint32_t second(Pair v) { return v.hi; }
};

}  // namespace closest
}  // namespace isoshell
