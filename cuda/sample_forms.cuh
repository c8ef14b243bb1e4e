// Forms of sample_sites' steps over leaves: a warp a leaf. Lanes take the leaf's triangles, then its sites.
#pragma once

#include "cuda/leaf_forms.cuh"
#include "stages/samples_body.h"

namespace isoshell {
namespace sample_forms {

constexpr int kBatch = 32;  ///< triangles whose voxels are held at one time

/// Voxels that a batch of the leaf's triangles meets, and the leaf's sites.
struct Batch {
  LeafMask met[kBatch];
  uint16_t offset[512];
  uint32_t triangle[kBatch];
};

/// Marks the voxels of the triangles from `at` on; returns how many triangles there are.
__device__ inline int mark_batch(const SurfaceView& surface, View<const uint32_t> triangles, Voxel leaf, int64_t at,
                                 int64_t end, Batch& batch, int lane) {
  __syncwarp();  // the last batch was read
  if (at + lane < end) {
    const uint32_t t = triangles[at + lane];
    LeafMask met = {};
    mark_voxels(surface.triangle(t), leaf, met);
    batch.met[lane] = met;
    batch.triangle[lane] = t;
  }
  __syncwarp();
  return int(end - at < kBatch ? end - at : kBatch);
}

struct BatchForm {
  static constexpr int kThreads = 32;
  static constexpr int kElements = 4;
  using Shared = Batch;
};

constexpr int kSitesOfLane = 512 / 32;  ///< a lane fills the lists of every 32nd site

}  // namespace sample_forms

template <>
struct BlockForm<CountSiteTriangles> : sample_forms::BatchForm {
  static __device__ void run(const CountSiteTriangles& step, int64_t l, Shared& batch, int lane) {
    using namespace sample_forms;
    const Voxel leaf = leaf_of_key(step.sites.leaf_key[l]);
    const int sites = leaf_forms::list_active(step.sites.mask[l], batch.offset, lane);
    int64_t* const count = &step.count[step.sites.first[l]];
    for (int k = lane; k < sites; k += 32) count[k] = 0;
    for (int64_t at = step.leaf_first[l], end = step.leaf_first[l + 1]; at < end; at += kBatch) {
      const int triangles = mark_batch(step.surface, step.leaf_triangle, leaf, at, end, batch, lane);
      for (int k = lane; k < sites; k += 32) {
        const int word = batch.offset[k] >> 6, bit = batch.offset[k] & 63;
        int seen = 0;
        for (int t = 0; t < triangles; ++t) seen += int(batch.met[t].word[word] >> bit & 1);
        if (seen) count[k] += seen;
      }
    }
  }
};

template <>
struct BlockForm<FillSiteTriangles> : sample_forms::BatchForm {
  static __device__ void run(const FillSiteTriangles& step, int64_t l, Shared& batch, int lane) {
    using namespace sample_forms;
    const Voxel leaf = leaf_of_key(step.sites.leaf_key[l]);
    const int sites = leaf_forms::list_active(step.sites.mask[l], batch.offset, lane);
    const int64_t* const first = &step.first[step.sites.first[l]];
    uint32_t filled[kSitesOfLane];
    for (uint32_t& n : filled) n = 0;
    for (int64_t at = step.leaf_first[l], end = step.leaf_first[l + 1]; at < end; at += kBatch) {
      const int triangles = mark_batch(step.surface, step.leaf_triangle, leaf, at, end, batch, lane);
#pragma unroll
      for (int j = 0; j < kSitesOfLane; ++j) {
        const int k = lane + 32 * j;
        if (k >= sites) break;
        const int word = batch.offset[k] >> 6, bit = batch.offset[k] & 63;
        for (int t = 0; t < triangles; ++t)
          if (batch.met[t].word[word] >> bit & 1) step.triangles[first[k] + filled[j]++] = batch.triangle[t];
      }
    }
  }
};

/// Sorts by counting the smaller ones; long lists by one lane in place.
template <>
struct BlockForm<SortLeafTriangles> {
  static constexpr int kThreads = 32;
  static constexpr int kElements = 4;
  static constexpr int kMost = 512;
  struct Shared {
    uint32_t triangle[kMost];
  };
  static __device__ void run(const SortLeafTriangles& step, int64_t l, Shared& list, int lane) {
    uint32_t* const all = &step.triangle[step.first[l]];
    const int64_t count = step.first[l + 1] - step.first[l];
    if (count > kMost) {
      if (lane == 0) sort_ascending(all, count);
      return;
    }
    for (int i = lane; i < count; i += 32) list.triangle[i] = all[i];
    __syncwarp();
    for (int i = lane; i < count; i += 32) {
      const uint32_t t = list.triangle[i];
      int before = 0;
      for (int j = 0; j < count; ++j) before += list.triangle[j] < t;
      all[before] = t;
    }
  }
};

template <>
struct BlockForm<SampleSites> : leaf_forms::LeafForm<leaf_forms::Offsets> {
  static __device__ void run(const SampleSites& step, int64_t l, Shared& shared, int lane) {
    const Voxel leaf = leaf_of_key(step.sites.leaf_key[l]);
    const int sites = leaf_forms::list_active(step.sites.mask[l], shared.offset, lane);
    const int64_t first = step.sites.first[l];
    for (int k = lane; k < sites; k += 32)
      step.sample[first + k] = step.nearest(voxel_centre(voxel_at(leaf, shared.offset[k])), first + k);
  }
};

}  // namespace isoshell
