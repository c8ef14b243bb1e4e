// Cooperative kernels of build_level_set.
#pragma once

#include "cuda/runtime/cooperative_kernel.cuh"
#include "cuda/runtime/warp.cuh"
#include "cuda/sparse/leaf_cooperative.cuh"
#include "stages/level_set/level_set_crossings.h"
#include "stages/level_set/level_set_distances.h"
#include "stages/level_set/level_set_solid.h"

namespace isoshell {
namespace level_set_cooperative {

using namespace level_set_steps;

constexpr int kWarps = 4;

/// Relative to a leaf's smallest corner, in floats that are wide enough for what rounding does to them.
constexpr float kSlack = 1e-3f;
constexpr double kMostRadius = 16;  ///< of balls; larger ones are infinite: planes alone count

__device__ inline float square(float a) { return a * a; }
/// To some bits less than exact.
__device__ inline float root(float a) {
  a = fmaxf(a, 1e-30f);
  return a * rsqrtf(a);
}
__device__ inline float height(float4 plane, float3 p) {
  return fmaf(plane.x, p.x, fmaf(plane.y, p.y, fmaf(plane.z, p.z, -plane.w)));
}
__device__ inline float4 local_plane(WorldPoint normal, double offset) {
  return {float(normal.x), float(normal.y), float(normal.z), float(offset)};
}

/// Where triangles of a leaf's list lie: in a plane, within three planes upright to it through their edges, and a ball.
template <int kMost>
struct LocalTriangles {
  float4 plane[kMost], edge[3][kMost], ball[kMost];

  __device__ void set(int i, const WorldPoint* corner, const Disc& disc, WorldPoint origin) {
    plane[i] = local_plane(disc.normal, disc.offset - dot(disc.normal, origin));
    for (int k = 0; k < 3; ++k) edge[k][i] = edge_plane(corner[k], corner[(k + 1) % 3], disc.normal, origin);
    const WorldPoint m = disc.middle - origin;
    ball[i] = disc.radius <= kMostRadius ? float4{float(m.x), float(m.y), float(m.z), float(disc.radius) + kSlack}
                                         : float4{0, 0, 0, INFINITY};
  }

  /// No more than the squared distance from the triangle.
  __device__ float least_sq(int i, float3 p) const {
    const float beside = fmaxf(fmaxf(height(edge[0][i], p), height(edge[1][i], p)), fmaxf(height(edge[2][i], p), 0));
    return fmaf(beside, beside, square(height(plane[i], p)));
  }

  /// False only for what is farther from all of a box.
  __device__ bool is_near_box(int i, float3 centre, float3 half, float distance) const {
    const float reach = distance + 2 * kSlack;
    if (fabsf(height(plane[i], centre)) > reach + tilt(plane[i], half)) return false;
    for (int k = 0; k < 3; ++k)
      if (height(edge[k][i], centre) > reach + tilt(edge[k][i], half)) return false;
    const float4 b = ball[i];
    const float x = fmaxf(fabsf(centre.x - b.x) - half.x, 0), y = fmaxf(fabsf(centre.y - b.y) - half.y, 0),
                z = fmaxf(fabsf(centre.z - b.z) - half.z, 0);
    return fmaf(x, x, fmaf(y, y, z * z)) <= square(b.w + reach);
  }

 private:
  /// Its height is positive outside of the triangle; zero everywhere where that is not known.
  __device__ static float4 edge_plane(WorldPoint a, WorldPoint b, WorldPoint normal, WorldPoint origin) {
    const WorldPoint out = cross(b - a, normal);
    const double size_sq = dot(out, out);
    if (!(size_sq > 0)) return {0, 0, 0, 0};
    const WorldPoint unit = rsqrt(size_sq) * out;
    return local_plane(unit, dot(unit, a - origin));
  }
  __device__ static float tilt(float4 plane, float3 half) {
    return fmaf(fabsf(plane.x), half.x, fmaf(fabsf(plane.y), half.y, fabsf(plane.z) * half.z));
  }
};

/// Bricks of 2 x 4 x 4 voxels, a voxel a lane.
constexpr int kBricks = 16;
struct Brick {
  int x, y, z;  ///< of its smallest voxel in the leaf

  __device__ explicit Brick(int number) : x(number >> 2 << 1), y((number >> 1 & 1) << 2), z((number & 1) << 2) {}
  __device__ int offset_of(int lane) const {
    return (x + (lane >> 4)) << 6 | (y + (lane >> 2 & 3)) << 3 | (z + (lane & 3));
  }
  __device__ float3 centre() const { return {x + 1.f, y + 2.f, z + 2.f}; }
  __device__ static float3 half() { return {.5f, 1.5f, 1.5f}; }  ///< of the box of its voxels' centres
};
__device__ inline float3 centre_of_offset(int offset) {
  return {(offset >> 6) + .5f, (offset >> 3 & 7) + .5f, (offset & 7) + .5f};
}

constexpr uint32_t kWhole = 1u << 31;
constexpr int kMost = 256;       ///< triangles at a time
constexpr int kMostQueued = 64;  ///< a warp
struct MeasureShared {
  LocalTriangles<kMost> local;
  uint32_t triangle[kMost];          ///< and in the highest bit whether it counts as a whole
  unsigned long long least_sq[512];  ///< bits of doubles, whose order is that of the numbers as none is negative
  uint16_t kept[kWarps][kMost];
  uint32_t queue[kWarps][kMostQueued];  ///< place of a triangle, offset of a voxel
  int next_brick;
};

/// What a warp does with a brick.
class BrickOfWarp {
 public:
  __device__ BrickOfWarp(const MeasureLeaf& step, MeasureShared& shared, WorldPoint origin, Brick brick, int count)
      : step_(step),
        s_(shared),
        origin_(origin),
        brick_(brick),
        count_(count),
        lane_(int(threadIdx.x & 31)),
        warp_(int(threadIdx.x >> 5)),
        offset_(brick.offset_of(lane_)),
        centre_(centre_of_offset(offset_)) {}

  __device__ void run(bool is_candidate) {
    is_candidate_ = is_candidate;
    if (!__any_sync(kWholeWarp, is_candidate)) return;
    int kept = keep<false>(count_);
    if (kept == 0) return;
    const int first = most_likely(kept);
    measure(offset_, first, is_candidate);
    __syncwarp();
    if (kept == 1) return;
    kept = keep<true>(kept);
    queue_others(kept, first);
  }

 private:
  __device__ float least() const { return root(float(__longlong_as_double(s_.least_sq[offset_]))); }

  /// Lists the triangles that may be nearest to a voxel of the brick: of all, or of those that are listed.
  template <bool kOfListed>
  __device__ int keep(int count) {
    const float farthest = __uint_as_float(warp_max(__float_as_uint(is_candidate_ ? least() : 0.f)));
    const float3 centre = brick_.centre(), half = Brick::half();
    uint16_t* const list = s_.kept[warp_];
    int kept = 0;
    for (int from = 0; from < count; from += 32) {
      const int i = from + lane_, place = i < count ? (kOfListed ? list[i] : i) : 0;
      const bool keeps = i < count && s_.local.is_near_box(place, centre, half, farthest);
      const unsigned lanes = __ballot_sync(kWholeWarp, keeps);
      __syncwarp();  // all have read their place in the list
      if (keeps) list[kept + lanes_before(lanes)] = uint16_t(place);
      kept += __popc(lanes);
      __syncwarp();
    }
    return kept;
  }

  /// The place of the one that is likely to be nearest to the lane's voxel.
  __device__ int most_likely(int kept) const {
    float best = INFINITY;
    int found = s_.kept[warp_][0];
    for (int k = 0; k < kept; ++k) {
      const int place = s_.kept[warp_][k];
      const float likely = s_.local.least_sq(place, centre_);
      if (likely < best) best = likely, found = place;
    }
    return found;
  }

  /// Queues what may be nearer than the first one, so that all lanes are busy with the exact distances.
  __device__ void queue_others(int kept, int first) {
    uint32_t* const queue = s_.queue[warp_];
    int queued = 0;
    float farthest = is_candidate_ ? least() : -1.f;
    for (int k = 0; k < kept; ++k) {
      const int place = s_.kept[warp_][k];
      const bool asks =
          farthest >= 0 && place != first && s_.local.least_sq(place, centre_) <= square(farthest + kSlack);
      const unsigned lanes = __ballot_sync(kWholeWarp, asks);
      if (asks) queue[queued + lanes_before(lanes)] = uint32_t(place << 9 | offset_);
      queued += __popc(lanes);
      __syncwarp();
      if (queued < 32) continue;
      queued -= 32;
      take(queue[queued + lane_], true);
      __syncwarp();
      if (is_candidate_) farthest = least();
    }
    take(lane_ < queued ? queue[lane_] : 0, lane_ < queued);
    __syncwarp();
  }
  __device__ void take(uint32_t queued, bool is_there) { measure(int(queued & 511), int(queued >> 9), is_there); }

  __device__ void measure(int offset, int place, bool is_there) {
    if (!is_there) return;
    const uint32_t t = s_.triangle[place] & ~kWhole;
    const WorldPoint p{origin_.x + (offset >> 6) + 0.5, origin_.y + (offset >> 3 & 7) + 0.5,
                       origin_.z + (offset & 7) + 0.5};
    const MeshPoint found = step_.triangles.nearest(p, t);
    if (found.distance_sq < __longlong_as_double(s_.least_sq[offset]) &&
        (s_.triangle[place] >= kWhole || step_.triangles.counts(t, found)))
      atomicMin(&s_.least_sq[offset], static_cast<unsigned long long>(__double_as_longlong(found.distance_sq)));
  }

  const MeasureLeaf& step_;
  MeasureShared& s_;
  const WorldPoint origin_;
  const Brick brick_;
  const int count_, lane_, warp_, offset_;
  const float3 centre_;
  bool is_candidate_ = false;
};

}  // namespace level_set_cooperative

/// A warp a brick. Floats say which triangles may be nearest to a voxel, after the exact distance to a likely one.
template <>
struct CooperativeKernel<level_set_steps::MeasureLeaf>
    : CooperativeKernelOf<level_set_steps::MeasureLeaf, 32 * level_set_cooperative::kWarps, 1> {
  using Step = level_set_steps::MeasureLeaf;
  using Shared = level_set_cooperative::MeasureShared;

  static __device__ void run(const Step& step, int64_t leaf, Shared& s, int lane) {
    using namespace level_set_cooperative;
    const Voxel at = voxel_at(leaf_of_key(step.candidates.leaf_key[leaf]), 0);
    const WorldPoint origin{double(at.x), double(at.y), double(at.z)};
    const LeafMask& mask = step.candidates.mask[leaf];
    for (int i = lane; i < 512; i += kThreads)
      s.least_sq[i] = static_cast<unsigned long long>(__double_as_longlong(step.band_vox * step.band_vox));
    const int64_t end = step.first[leaf + 1];
    for (int64_t from = step.first[leaf]; from < end; from += kMost) {
      const int count = int(end - from < kMost ? end - from : kMost);
      __syncthreads();
      if (lane == 0) s.next_brick = 0;
      for (int i = lane; i < count; i += kThreads) {
        const uint32_t t = step.listed[from + i];
        const Disc& disc = step.triangles.disc[t];
        s.triangle[i] = t | (disc.counts_whole ? kWhole : 0);
        s.local.set(i, step.triangles.of(t), disc, origin);
      }
      __syncthreads();
      for (int b = take_brick(s); b < kBricks; b = take_brick(s)) {
        const Brick brick(b);
        BrickOfWarp(step, s, origin, brick, count).run(is_on(mask, brick.offset_of(lane & 31)));
      }
    }
    __syncthreads();
    store(step, leaf, mask, s, lane);
  }

 private:
  /// Warps that are done early take more of them.
  static __device__ int take_brick(Shared& s) {
    __syncwarp();
    const int brick = (threadIdx.x & 31) == 0 ? atomicAdd(&s.next_brick, 1) : 0;
    return __shfl_sync(kWholeWarp, brick, 0);
  }
  static __device__ void store(const Step& step, int64_t leaf, const LeafMask& mask, const Shared& s, int lane) {
    for (int offset = lane; offset < 512; offset += kThreads) {
      const double found = std::sqrt(__longlong_as_double(s.least_sq[offset]));
      const bool is_candidate = is_on(mask, offset);
      if (is_candidate) step.distance[step.candidates.first[leaf] + rank_in_leaf(mask, offset)] = float(found);
      const unsigned bits = __ballot_sync(kWholeWarp, is_candidate && found < step.band_vox);
      if ((lane & 31) == 0) reinterpret_cast<uint32_t*>(step.active[leaf].word)[offset >> 5] = bits;
    }
  }
};

template <>
struct CooperativeKernel<level_set_steps::BlockSteps> : CooperativeKernelOf<level_set_steps::BlockSteps> {
  struct Shared {};
  static __device__ void run(const level_set_steps::BlockSteps& step, int64_t leaf, Shared&, int lane) {
    const unsigned axes = step.open_axes(leaf);
    if (axes == 0) return;
    const Voxel origin = voxel_at(leaf_of_key(step.leaf_key[leaf]), 0);
    const int64_t end = step.first[leaf + 1];
    for (int64_t from = step.first[leaf]; from < end; from += 32) {
      const uint32_t t = from + lane < end ? step.listed[from + lane] : 0;
      block(step, leaf, origin, axes, t, __ballot_sync(kWholeWarp, from + lane < end && step.may_meet(origin, t)),
            lane);
    }
  }

 private:
  /// The triangles of the lanes `may_meet`. Few are large, so that several lanes share each.
  static __device__ void block(const level_set_steps::BlockSteps& step, int64_t leaf, Voxel origin, unsigned axes,
                               uint32_t of_lane, unsigned may_meet, int lane) {
    const int count = __popc(may_meet);
    const int parts = count <= 1 ? 32 : count <= 2 ? 16 : count <= 4 ? 8 : 4;
    for (int first = 0; first < count; first += 32 / parts) {
      const int n = first + lane / parts;
      const uint32_t t = __shfl_sync(kWholeWarp, of_lane, n < count ? int(__fns(may_meet, 0, n + 1)) : 0);
      if (n < count) step.block(leaf, origin, axes, t, lane % parts, parts);
      __syncwarp();
    }
  }
};

template <>
struct CooperativeKernel<level_set_steps::ListCorners>
    : leaf_cooperative::CooperativeLeaf<level_set_steps::ListCorners, leaf_cooperative::Offsets> {
  static __device__ void run(const level_set_steps::ListCorners& step, int64_t leaf, Shared& shared, int lane) {
    const int count = leaf_cooperative::list_active(step.corners.mask[leaf], shared.offset, lane);
    const Voxel at = leaf_of_key(step.corners.leaf_key[leaf]);
    const int64_t first = step.corners.first[leaf];
    for (int i = lane; i < count; i += 32) step.corner[first + i] = voxel_at(at, shared.offset[i]);
  }
};

}  // namespace isoshell
