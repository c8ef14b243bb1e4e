// PlainProjectVertices (see stages/sheet/sheet_project_body.h) on the device: a block of threads a leaf of corners, a
// thread a vertex. The block lists the triangles near its leaf once; a vertex is compared with those whose boxes are
// not farther than the nearest one so far. Vertices that are far from all of them search alone, as the step does.
#pragma once

#include "cuda/runtime/executor_cuda.cuh"
#include "stages/sheet/sheet_project_body.h"
#include "voxel/point_grid.h"

namespace isoshell {
namespace project_leaves {

constexpr int kThreads = 128;
constexpr int kMostNear = 1024;                ///< triangles near a leaf; where there are more, vertices search alone
constexpr uint32_t kSlots = 2 * kMostNear;     ///< a power of two
constexpr int32_t kFar = 2 * kOneVoxelQ8 - 1;  ///< farther vertices may be bridges
constexpr int32_t kMostLocal = INT16_MAX;
constexpr int kMostLeaves = 64;  ///< around a leaf; two threads each
constexpr int kPairs = 64;       ///< of a vertex and a triangle, that wait

/// Triangles near a leaf, with the boxes around them from the block's origin on.
struct NearTriangles {
  uint32_t slot[kSlots];
  uint32_t triangle[kMostNear];
  int16_t lo[3][kMostNear], hi[3][kMostNear];
  int count;
  BoxQ8 box;  ///< of the leaf's vertices

  /// Each once. `count` passes kMostNear where they do not fit.
  __device__ void insert(uint32_t t) {
    for (uint32_t at = (t * 2654435761u) >> 21; *static_cast<volatile int*>(&count) <= kMostNear; ++at) {
      const uint32_t seen = atomicCAS(&slot[at & (kSlots - 1)], kNone, t);
      if (seen == t) return;
      if (seen != kNone) continue;
      const int place = atomicAdd(&count, 1);
      if (place < kMostNear) triangle[place] = t;
      return;
    }
  }

  __device__ void measure(int i, const TriangleIndices& corner, View<const PointQ8> points) {
    const PointQ8 a = points[corner.a], b = points[corner.b], c = points[corner.c], o = box.lo;
    const auto range = [&](int axis, int32_t of_a, int32_t of_b, int32_t of_c, int32_t from) {
      lo[axis][i] = int16_t(max(min(min(of_a, of_b), of_c) - from, -kMostLocal));
      hi[axis][i] = int16_t(min(max(max(of_a, of_b), of_c) - from, kMostLocal));
    };
    range(0, a.x, b.x, c.x, o.x);
    range(1, a.y, b.y, c.y, o.y);
    range(2, a.z, b.z, c.z, o.z);
  }

  __device__ int32_t distance_sq_to_box(int i, PointQ8 local) const {
    const auto gap = [&](int axis, int32_t p) { return max(max(lo[axis][i] - p, p - hi[axis][i]), 0); };
    const int32_t x = gap(0, local.x), y = gap(1, local.y), z = gap(2, local.z);
    return x * x + y * y + z * z;
  }
};

__device__ inline void include_warp(BoxQ8& of_block, PointQ8 p, bool exists) {
  const auto lowest = [&](int32_t& to, int32_t x) {
    const int32_t least = warp_min(exists ? x : INT32_MAX);
    if ((threadIdx.x & 31) == 0) atomicMin(&to, least);
  };
  const auto highest = [&](int32_t& to, int32_t x) {
    const int32_t most = warp_max(exists ? x : INT32_MIN);
    if ((threadIdx.x & 31) == 0) atomicMax(&to, most);
  };
  lowest(of_block.lo.x, p.x);
  lowest(of_block.lo.y, p.y);
  lowest(of_block.lo.z, p.z);
  highest(of_block.hi.x, p.x);
  highest(of_block.hi.y, p.y);
  highest(of_block.hi.z, p.z);
}

/// The leaves of sites around a leaf of corners.
struct LeavesAround {
  Voxel lo;       ///< the first of them
  int across[3];  ///< how many along each axis
  uint64_t word[kMostLeaves][8];
  int64_t first[kMostLeaves];       ///< site of each leaf
  uint16_t before[kMostLeaves][8];  ///< sites of the leaf before each word

  __device__ int count() const { return across[0] * across[1] * across[2]; }
  __device__ int number(Voxel leaf) const {
    return ((leaf.x - lo.x) * across[1] + leaf.y - lo.y) * across[2] + leaf.z - lo.z;
  }
  /// By the whole block, of the leaves that have voxels from `from` to `to`. False where they do not fit.
  __device__ bool load(const VoxelSetView& sites, Voxel from, Voxel to) {
    const auto leaf_of = [](Voxel v) { return Voxel{v.x >> 3, v.y >> 3, v.z >> 3}; };
    const Voxel begin = leaf_of(from), end = leaf_of(to);
    const int x = end.x - begin.x + 1, y = end.y - begin.y + 1, z = end.z - begin.z + 1;
    if (int64_t(x) * y * z > kMostLeaves) return false;
    if (threadIdx.x == 0) lo = begin, across[0] = x, across[1] = y, across[2] = z;
    const int n = int(threadIdx.x) >> 1;  // two threads a leaf, four words each
    if (n < x * y * z) {
      const uint32_t leaf = find_leaf(sites, {begin.x + n / (y * z), begin.y + n / z % y, begin.z + n % z});
      const int half = (threadIdx.x & 1) * 4;
      for (int w = half; w < half + 4; ++w) word[n][w] = leaf == kNone ? 0 : sites.mask[leaf].word[w];
      if (half == 0) first[n] = leaf == kNone ? 0 : sites.first[leaf];
    }
    __syncthreads();
    if (threadIdx.x < kMostLeaves && int(threadIdx.x) < x * y * z) {
      int sum = 0;
      for (int w = 0; w < 8; ++w) {
        before[threadIdx.x][w] = uint16_t(sum);
        sum += popcount64(word[threadIdx.x][w]);
      }
    }
    __syncthreads();
    return true;
  }
};

/// Lists the triangles of the sites from one voxel to another; by the whole block.
__device__ inline void list_near(const SitedSurfaceView& surface, const LeavesAround& leaves, Voxel from, Voxel to,
                                 NearTriangles& near) {
  const int rows = (to.x - from.x + 1) * (to.y - from.y + 1), pieces = rows * leaves.across[2];
  for (int i = int(threadIdx.x); i < pieces; i += kThreads) {
    const int row = i % rows;
    const Voxel at = {from.x + row / (to.y - from.y + 1), from.y + row % (to.y - from.y + 1),
                      max(from.z, (leaves.lo.z + i / rows) * 8)};
    const int n = leaves.number({at.x >> 3, at.y >> 3, at.z >> 3}), w = at.x & 7;
    const int first_bit = (at.y & 7) << 3 | (at.z & 7), last_bit = (at.y & 7) << 3 | min(to.z - (at.z & ~7), 7);
    const uint64_t word = leaves.word[n][w], until = word & (~uint64_t(0) >> (63 - last_bit)),
                   here = until & (~uint64_t(0) << first_bit);
    if (here == 0) continue;
    const int64_t end = leaves.first[n] + leaves.before[n][w] + popcount64(until);
    for (int64_t k = surface.site_first[end - popcount64(here)]; k < surface.site_first[end]; ++k)
      near.insert(surface.site_triangles[k]);
  }
}

/// The nearest triangles of 32 vertices, one a lane. Distances and triangles in one word: the least is the nearest, and
/// of equals the one with the least number.
class NearestOfWarp {
 public:
  struct Room {
    uint64_t best[32];
    uint32_t pair[kPairs];  ///< vertex << 16 | triangle of the list
  };
  __device__ NearestOfWarp(const NearTriangles& near, const SitedSurfaceView& surface, PointQ8 p, bool exists,
                           Room& room)
      : near_(near), surface_(surface), room_(room), p_(p), exists_(exists), lane_(int(threadIdx.x) & 31) {}

  /// The nearest triangle within kFar, or none.
  __device__ NearestTriangle find() {
    constexpr uint64_t kNoneWithinReach = uint64_t(kFar) * kFar << 32 | kNone;
    room_.best[lane_] = kNoneWithinReach;
    __syncwarp();
    if (near_.count > 0) {
      compare_with_nearest_boxes();
      compare_with_rest();
    }
    const uint64_t best = room_.best[lane_];
    if (uint32_t(best) == kNone) return {};
    return {int64_t(best >> 32), uint32_t(best), foot_of(p_, uint32_t(best))};
  }

 private:
  __device__ PointQ8 local() const {
    const PointQ8 o = near_.box.lo;
    return {p_.x - o.x, p_.y - o.y, p_.z - o.z};
  }
  __device__ PointQ8 foot_of(PointQ8 p, uint32_t t) const {
    const TriangleIndices& corner = surface_.triangles[t];
    return closest_point_on_triangle(p, surface_.points[corner.a], surface_.points[corner.b],
                                     surface_.points[corner.c]);
  }
  __device__ void compare(PointQ8 p, int lane, int i) {
    const uint32_t t = near_.triangle[i];
    const uint64_t d = uint64_t(distance_sq_q16(p, foot_of(p, t)));
    if (d <= uint64_t(kFar) * kFar)
      atomicMin(reinterpret_cast<unsigned long long*>(&room_.best[lane]), (unsigned long long)(d << 32 | t));
  }

  /// Of each vertex's nearest box: what is farther than its triangle need not be looked at.
  __device__ void compare_with_nearest_boxes() {
    int32_t least = INT32_MAX;
    for (int i = 0; i < near_.count; ++i) {
      const int32_t d = near_.distance_sq_to_box(i, local());
      if (d < least) least = d, first_ = i;
    }
    if (exists_) compare(p_, lane_, first_);
    __syncwarp();
  }

  /// Pairs are gathered until there is one for every lane.
  __device__ void compare_with_rest() {
    int pairs = 0;
    for (int i = 0; i < near_.count; ++i) {
      const int64_t d = near_.distance_sq_to_box(i, local());
      const bool is_wanted = exists_ && i != first_ && d <= int64_t(room_.best[lane_] >> 32);
      const unsigned wanted = __ballot_sync(kWholeWarp, is_wanted);
      if (wanted == 0) continue;
      if (is_wanted) room_.pair[pairs + lanes_before(wanted)] = uint32_t(lane_) << 16 | uint32_t(i);
      pairs += __popc(wanted);
      __syncwarp();
      if (pairs >= 32) compare_pairs(pairs -= 32, 32);
    }
    compare_pairs(0, pairs);
  }
  __device__ void compare_pairs(int begin, int count) {
    const uint32_t pair = room_.pair[lane_ < count ? begin + lane_ : 0];
    const int of = lane_ < count ? int(pair >> 16) : 0;
    const PointQ8 p = {__shfl_sync(kWholeWarp, p_.x, of), __shfl_sync(kWholeWarp, p_.y, of),
                       __shfl_sync(kWholeWarp, p_.z, of)};
    if (lane_ < count) compare(p, of, int(pair & 0xffff));
    __syncwarp();
  }

  const NearTriangles& near_;
  const SitedSurfaceView& surface_;
  Room& room_;
  const PointQ8 p_;
  const bool exists_;
  const int lane_;
  int first_ = 0;  ///< whose box is nearest
};

struct Room {
  NearTriangles near;
  union {
    LeavesAround leaves;                         // while triangles are listed
    NearestOfWarp::Room of_warp[kThreads / 32];  // afterwards
  };
};

/// Lists what may be the nearest triangle of a vertex that is not far; by the whole block. False where it does not fit.
__device__ inline bool list_near(const SitedSurfaceView& surface, Room& room) {
  const auto voxel = [](PointQ8 p, int32_t by) {
    return Voxel{(p.x + by) >> kFractionBits, (p.y + by) >> kFractionBits, (p.z + by) >> kFractionBits};
  };
  NearTriangles& near = room.near;
  const Voxel from = voxel(near.box.lo, -(kFar + 1)), to = voxel(near.box.hi, kFar + 1);
  if (!room.leaves.load(surface.sites, from, to)) return false;
  list_near(surface, room.leaves, from, to, near);
  __syncthreads();
  if (near.count > kMostNear) return false;
  for (int i = int(threadIdx.x); i < near.count; i += kThreads)
    near.measure(i, surface.triangles[near.triangle[i]], surface.points);
  __syncthreads();
  return true;
}

__global__ void __launch_bounds__(kThreads) project(VoxelSetView corners, sheet_steps::ProjectVertex step) {
  __shared__ Room room;
  NearTriangles& near = room.near;
  const int64_t begin = corners.first[blockIdx.x], end = corners.first[blockIdx.x + 1];
  if (begin == end) return;
  const int thread = int(threadIdx.x);
  for (uint32_t i = threadIdx.x; i < kSlots; i += kThreads) near.slot[i] = kNone;
  if (thread == 0) {
    near.count = 0;
    near.box = {{INT32_MAX, INT32_MAX, INT32_MAX}, {INT32_MIN, INT32_MIN, INT32_MIN}};
  }
  __syncthreads();
  for (int64_t base = begin; base < end; base += kThreads) {
    const bool exists = base + thread < end;
    include_warp(near.box, step.smooth[exists ? base + thread : begin], exists);
  }
  __syncthreads();
  const bool fits = list_near(step.surface, room);
  for (int64_t base = begin; base < end; base += kThreads) {
    const bool exists = base + thread < end;
    const int64_t v = exists ? base + thread : begin;
    NearestTriangle best;
    if (fits) best = NearestOfWarp(near, step.surface, step.smooth[v], exists, room.of_warp[thread / 32]).find();
    if (!exists) continue;
    if (best.triangle == kNone) {
      step(v);
    } else {
      step.position[v] = best.point;
      step.source_triangle[v] = best.triangle;
    }
  }
}

}  // namespace project_leaves

struct ProjectByLeaves {
  static void run(CudaExecutor& exec, const VoxelSetView& corners, const sheet_steps::ProjectVertex& step) {
    if (corners.leaf_key.empty()) return;
    project_leaves::project<<<unsigned(corners.leaf_key.size), project_leaves::kThreads, 0, exec.stream()>>>(corners,
                                                                                                             step);
    exec.check("project");
  }
};

}  // namespace isoshell
