// What the distance transform over rows of leaves reads and writes, and its tables in shared memory.
#pragma once

#include "cuda/closest_keys.cuh"
#include "isoshell/voxel_set.h"

namespace isoshell {
namespace closest {

struct Rows {
  View<const uint32_t> first_leaf;  ///< of each row: number of its first leaf; a prefix of the array is in use
  const uint32_t* count;
  uint32_t* next;  ///< row to take next; 0 at the start
  int32_t leaves;  ///< of a row at most: 1, 2, 4 or 8; rows start at multiples of it
};

/// A word of the sites' masks, and the site id of its first voxel.
struct alignas(16) SiteWord {
  uint64_t bits;
  uint32_t first;
};

struct Input {
  VoxelSetView sites, shell;
  const SiteWord* words;  ///< of the sites' leaves, eight each
  int32_t band_vox;
};

struct Output {
  LeafMask* mask;  ///< DistancePair: the leaves' masks and numbers of voxels
  int64_t* count;
  uint32_t* closest_site;  ///< others: the values
  uint16_t* distance_sq_vox;
};

template <int kReach>
struct Window {
  static constexpr int kSpan = 2 * kReach + 1;                         ///< leaves across
  static constexpr int kColumns = kSpan * kSpan;                       ///< of leaves along x
  static constexpr int kPlaces = site_order::kRowLeaves + 2 * kReach;  ///< of leaves along x
  static constexpr int kMiddle = 8 * kReach;                           ///< first voxel of the middle leaf
};

/// Planes of voxels that are listed at a time before their values are written.
template <class Keys>
constexpr int kListed = sizeof(typename Keys::Pair) > 4 ? 2 : 8;

template <class Keys>
constexpr bool kLarge = sizeof(typename Keys::Pair) > 4;

template <class Keys, int kReach>
struct alignas(16) Shared {
  using W = Window<kReach>;
  uint32_t keys[W::kSpan][8 * Keys::kPlaneWords];  ///< after the y pass, by place along x modulo the span, x, y, z
  typename Keys::Pair along_z[kLarge<Keys> ? 2 : 1][4][kLarge<Keys> ? W::kMiddle + 2 : 1];  ///< by side, pair, steps
  uint32_t site_leaf[W::kPlaces * W::kColumns];
  uint32_t some[W::kPlaces];  ///< four bits a plane: whether it has keys
  uint32_t shell_leaf[W::kPlaces];
  uint32_t list[Keys::kValues ? 64 * kListed<Keys> : 1];
  uint16_t offset[Keys::kValues && kLarge<Keys> ? 64 * kListed<Keys> : 2];
  uint16_t decoder[Keys::kDecoderEntries];
};

/// Of a thread block, in words.
template <int kBand>
constexpr int kTableWords = kBand == 0   ? 8 * (2 * kMaxBandVox + 8)
                            : kBand <= 3 ? 1024 + 8
                                         : 8;

/// A thread block, so that it fits the smallest chip's shared memory with its table.
template <class Keys, int kReach>
constexpr int kWarps = 8 * sizeof(Shared<Keys, kReach>) < 59000   ? 8
                       : 4 * sizeof(Shared<Keys, kReach>) < 59000 ? 4
                                                                  : 2;

__device__ inline uint32_t or_of_warp(uint32_t bits) {
#if __CUDA_ARCH__ >= 800
  return __reduce_or_sync(kAllLanes, bits);
#else
  for (int offset = 16; offset > 0; offset >>= 1) bits |= __shfl_xor_sync(kAllLanes, bits, offset);
  return bits;
#endif
}

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
        if (bits >> (at - lowest) & 1)
          best = (uint32_t(step * step) << Keys::kBits) + (Keys::kBits ? uint32_t(at >> 3) * 8 : 0);
      }
    entry |= best << (16 * half);
  }
  return entry;
}

/// The thread block's tables: costs[r][t] for bands that are not known when compiling, of a step from the r-th row or
/// plane of the window to the t-th of the leaf; else roots of small squares, and keys along z by table_entry.
template <int kBand, class Keys>
__device__ inline void fill_tables(uint32_t* table, int band) {
  const int thread = int(threadIdx.x), threads = int(blockDim.x);
  if constexpr (kBand == 0) {
    for (int i = thread; i < 8 * (2 * band + 8); i += threads) {
      const int step = (i >> 3) - band - (i & 7);
      table[i] = Keys::cost(step >= -band && step <= band ? step * step : band * band + 1);
    }
  } else {
    if (thread < 32) {
      int root = 0;
      while ((root + 1) * (root + 1) <= thread) ++root;
      reinterpret_cast<uint8_t*>(table)[thread] = uint8_t(root);
    }
    if constexpr (kBand <= 3)
      for (int i = thread; i < 1024; i += threads) table[8 + i] = table_entry<Keys>(i >> 8, i & 255, band);
  }
}

}  // namespace closest
}  // namespace isoshell
