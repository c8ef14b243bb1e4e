// What the distance transform over rows of leaves keeps in shared memory.
#pragma once

#include "cuda/runtime/warp.cuh"
#include "cuda/shell/closest_far.cuh"
#include "cuda/shell/closest_keys.cuh"

namespace isoshell {
namespace closest {

/// Distance along one axis from the nearest voxel of a leaf to the leaf `leaves` away.
ISOSHELL_HD constexpr int leaf_gap(int leaves) { return leaves == 0 ? 0 : (leaves < 0 ? -leaves : leaves) * 8 - 7; }

template <int kReach>
struct Window {
  static constexpr int kSpan = 2 * kReach + 1;                         ///< leaves across
  static constexpr int kColumns = kSpan * kSpan;                       ///< of leaves along x
  static constexpr int kPlaces = site_order::kRowLeaves + 2 * kReach;  ///< of leaves along x
  static constexpr int kMiddle = 8 * kReach;                           ///< first voxel of the middle leaf
};

/// Planes of voxels that are listed at a time before their values are written.
template <class Keys>
constexpr int kListed = sizeof(typename Keys::Pair) > 4 ? 2 : 4;

template <class Keys>
constexpr bool kLarge = sizeof(typename Keys::Pair) > 4;

/// A leaf of sites in the window: number of its first word, byte of its keys after the y pass, and above 24 bits what
/// to add to z there.
struct alignas(8) SiteLeaf {
  uint32_t first_word;
  int32_t keys_and_z;
};

template <int kReach, int kBand, class Keys>
struct alignas(16) Shared {
  using W = Window<kReach>;
  static constexpr int kNearest = kLarge<Keys> ? W::kMiddle + 2 : kBand > 3 ? kMostSteps<kBand> + 2 : 1;
  uint32_t keys[W::kSpan][8 * Keys::kPlaneWords];  ///< after the y pass, by place along x modulo the span, x, y, z
  typename Keys::Pair along_z[2][4][kNearest];     ///< by side, pair, steps
  uint32_t site_leaf[W::kPlaces * W::kColumns];
  uint32_t some[W::kPlaces];  ///< four bits a plane: whether it has keys
  uint32_t shell_leaf[W::kPlaces];
  uint32_t list[64 * kListed<Keys>];
  uint16_t offset[kLarge<Keys> ? 64 * kListed<Keys> : 2];
  SiteLeaf sites[Keys::kSites];  ///< of the window of a leaf, by digits
  typename Keys::Order order;
  FarVoxels<kBand> far;
};

/// Of a thread block, in words.
constexpr int kNearestWords = 8 * 256 / 4;
template <int kBand>
constexpr int kTableWords = kBand == 0   ? 8 * (2 * kMaxBandVox + 8)
                            : kBand <= 3 ? 1024 + kNearestWords
                                         : kNearestWords;

/// A thread block, so that it fits the smallest chip's shared memory with its table.
template <int kReach, int kBand, class Keys>
constexpr int kWarps = 8 * sizeof(Shared<kReach, kBand, Keys>) < 59000   ? 8
                       : 4 * sizeof(Shared<kReach, kBand, Keys>) < 59000 ? 4
                                                                         : 2;

/// For pairs of voxels and the eight bits of a row from three below the pair to three above it: keys along z.
template <class Keys>
__device__ inline uint32_t table_entry(int pair, int bits, int band) {
  uint32_t entry = 0;
  for (int half = 0; half < 2; ++half) {
    const int z = 8 + 2 * pair + half, lowest = 8 + 2 * pair - 3;
    uint32_t best = uint32_t(band * band + 1) << Keys::kBits;
    for (int step = band; step >= 0; --step)
      for (int side = 1; side >= -1; side -= 2) {
        const int at = z + side * step;
        if (bits >> (at - lowest) & 1) best = (uint32_t(step * step) << Keys::kBits) + uint32_t(at >> 3) * 8;
      }
    entry |= best << (16 * half);
  }
  return entry;
}

/// Of four rows of the leaf, the bits that matter to a pair of voxels, a byte each: the eight voxels of a row that are
/// around the pair, of which some lie in the leaf before or after it along z.
struct RowsAround {
  int up, down;  ///< how far the leaf's own bits move
  uint32_t own;  ///< where they then lie
  int other_leaf, other_up, other_down;

  __device__ explicit RowsAround(int pair)
      : up(pair == 0   ? 3
           : pair == 1 ? 1
                       : 0),
        down(pair == 2   ? 1
             : pair == 3 ? 3
                         : 0),
        own(0x01010101u * ((0xffu << up & 0xffu) >> down)),
        other_leaf(pair < 2 ? 0 : 2),
        other_up(pair < 2 ? 0 : 8 - down),
        other_down(pair < 2 ? 8 - up : 0) {}

  __device__ uint32_t of(uint32_t middle, uint32_t other) const {
    return (middle << up >> down & own) | (other << other_up >> other_down & ~own);
  }
};

/// Of the eight bits of a row, not 0, the one nearest to z, the lower one of two.
__device__ inline uint32_t nearest_bit(uint32_t row, int z) {
  const uint32_t below = row & ((2u << z) - 1), above = row >> z << z;
  const int lower = 31 - __clz(int(below)), upper = __ffs(int(above)) - 1;
  return uint32_t(!above || (below && z - lower <= upper - z) ? lower : upper);
}

/// The thread block's tables: costs[r][t] for bands that are not known when compiling, of a step from the r-th row or
/// plane of the window to the t-th of the leaf; else nearest bits by z and row, and keys along z by table_entry.
template <int kBand, class Keys>
__device__ inline void fill_tables(uint32_t* table, int band) {
  const int thread = int(threadIdx.x), threads = int(blockDim.x);
  if constexpr (kBand == 0) {
#pragma unroll 1
    for (int i = thread; i < 8 * (2 * band + 8); i += threads) {
      const int step = (i >> 3) - band - (i & 7);
      table[i] = Keys::cost(step >= -band && step <= band ? step * step : band * band + 1);
    }
  } else {
#pragma unroll 1
    for (int i = thread; i < 4 * kNearestWords; i += threads)
      reinterpret_cast<uint8_t*>(table)[i] = uint8_t(nearest_bit(uint32_t(i & 255), i >> 8));
    if constexpr (kBand <= 3)
#pragma unroll 1
      for (int i = thread; i < 1024; i += threads) table[kNearestWords + i] = table_entry<Keys>(i >> 8, i & 255, band);
  }
}

}  // namespace closest
}  // namespace isoshell
