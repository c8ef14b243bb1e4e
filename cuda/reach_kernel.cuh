// Which voxels of a leaf lie within a small band of a site: the sites' bitmaps grown by the ball, 64 voxels at a time.
#pragma once

#include "voxel/leaf.h"

namespace isoshell {
namespace reach {

constexpr int kMaxBand = 4;  ///< the planes of a leaf and its band fit 16 lanes
constexpr int kThreads = 128;

/// Half-length along z of the ball of radius `band` at (dx, dy); -1 outside.
ISOSHELL_HD constexpr int half_length(int band, int dx, int dy) {
  int half = -1;
  while (dx * dx + dy * dy + (half + 1) * (half + 1) <= band * band) ++half;
  return half;
}

/// The slice moved by `by` voxels along z, where below and above continue it. Rows are bytes.
__device__ inline uint64_t moved_up_z(uint64_t slice, uint64_t below, int by) {
  const uint64_t own = 0x0101010101010101ull * (0xffu << by & 0xffu);
  return (slice << by & own) | (below >> (8 - by) & ~own);
}
__device__ inline uint64_t moved_down_z(uint64_t slice, uint64_t above, int by) {
  const uint64_t own = 0x0101010101010101ull * (0xffu >> by);
  return (slice >> by & own) | (above << (8 - by) & ~own);
}

/// Rows y + dy of three slices along y.
__device__ inline uint64_t rows_at(const uint64_t (&slice)[3], int dy) {
  if (dy == 0) return slice[1];
  if (dy > 0) return slice[1] >> (8 * dy) | slice[2] << (64 - 8 * dy);
  return slice[1] << (-8 * dy) | slice[0] >> (64 + 8 * dy);
}

/// 16 lanes a leaf; a lane has one plane across x of the leaf and its band.
template <int kBand>
__global__ void __launch_bounds__(kThreads)
    grow_sites(VoxelSetView sites, VoxelSetView shell, LeafMask* mask, int64_t* count) {
  static_assert(kBand <= kMaxBand, "planes must fit the lanes");
  constexpr unsigned kAllLanes = 0xffffffffu;
  const int64_t l = (int64_t(blockIdx.x) * kThreads + threadIdx.x) >> 4;
  const int lane = int(threadIdx.x & 15), plane = 8 - kBand + lane;
  const bool some = l < shell.leaf_key.size;
  const Voxel at = leaf_of_key(shell.leaf_key[some ? l : 0]);
  const auto neighbour = [&](int n) {
    return n < 27 ? find_leaf(sites, {at.x + n / 9 - 1, at.y + n / 3 % 3 - 1, at.z + n % 3 - 1}) : kNone;
  };
  const uint32_t low = neighbour(lane), high = neighbour(16 + lane);

  uint64_t grown_z[kBand + 1][3];
#pragma unroll
  for (int y = 0; y < 3; ++y) {
    uint64_t word[3];
#pragma unroll
    for (int z = 0; z < 3; ++z) {
      const int n = (plane >> 3) * 9 + y * 3 + z;
      const uint32_t in_low = __shfl_sync(kAllLanes, low, n & 15, 16),
                     in_high = __shfl_sync(kAllLanes, high, n & 15, 16);
      const uint32_t leaf = n < 16 ? in_low : in_high;
      word[z] = 0;
      if (lane < 8 + 2 * kBand && leaf != kNone) word[z] = sites.mask.data[leaf].word[plane & 7];
    }
    grown_z[0][y] = word[1];
#pragma unroll
    for (int by = 1; by <= kBand; ++by)
      grown_z[by][y] = grown_z[by - 1][y] | moved_up_z(word[1], word[0], by) | moved_down_z(word[1], word[2], by);
  }
  uint64_t out = 0;
#pragma unroll
  for (int dx = 0; dx <= kBand; ++dx) {
    uint64_t disc = 0;
#pragma unroll
    for (int dy = -kBand; dy <= kBand; ++dy) {
      const int half = half_length(kBand, dx, dy);
      if (half >= 0) disc |= rows_at(grown_z[half], dy);
    }
    if (dx == 0)
      out = disc;
    else
      out |= __shfl_sync(kAllLanes, disc, (lane - dx) & 15, 16) | __shfl_sync(kAllLanes, disc, (lane + dx) & 15, 16);
  }
  const bool inside = lane >= kBand && lane < kBand + 8;
  int voxels = inside ? __popcll(out) : 0;
  for (int offset = 8; offset > 0; offset >>= 1) voxels += __shfl_xor_sync(kAllLanes, voxels, offset);
  if (!some) return;
  if (inside) mask[l].word[lane - kBand] = out;
  if (lane == 0) count[l] = voxels;
}

}  // namespace reach
}  // namespace isoshell
