// sample_sites on the device: a thread a leaf and triangle, then a warp a leaf with a lane a site.
#pragma once

#include "cuda/runtime/executor_cuda.cuh"
#include "cuda/sparse/leaf_cooperative.cuh"
#include "stages/sites/samples_body.h"

namespace isoshell {
namespace sample_cooperative {

/// Voxels of a leaf that one triangle of its list meets; by places in the lists, so that lists of any length share the
/// work.
struct MarkMet {
  SurfaceView surface;
  View<const uint64_t> leaf_key;
  View<const int64_t> first;
  View<const uint32_t> triangle;
  View<LeafMask> met;
  ISOSHELL_HD void operator()(int64_t place) const {
    int64_t lo = 0, hi = leaf_key.size;  // the last leaf that starts at the place or before
    while (hi - lo > 1) {
      const int64_t middle = lo + (hi - lo) / 2;
      (first[middle] <= place ? lo : hi) = middle;
    }
    LeafMask mask = {};
    mark_voxels(surface.triangle(triangle[place]), leaf_of_key(leaf_key[lo]), mask);
    met[place] = mask;
  }
};

/// The sites of a leaf and the lists that they get.
struct SitesOfLeaf {
  VoxelSetView sites;
  View<const int64_t> leaf_first;
  View<const LeafMask> met;

  /// Calls visit(place) for the triangles that meet the voxel, in order.
  template <class Visit>
  ISOSHELL_HD void for_each_triangle(int64_t leaf, int offset, Visit visit) const {
    for (int64_t place = leaf_first[leaf]; place < leaf_first[leaf + 1]; ++place)
      if (met[place].word[offset >> 6] >> (offset & 63) & 1) visit(place);
  }
};
struct CountMet {
  SitesOfLeaf of;
  View<int64_t> count;
};
struct FillMet {
  SitesOfLeaf of;
  View<const uint32_t> leaf_triangle;
  View<const int64_t> first;
  View<uint32_t> triangles;
};

/// Calls visit(offset, site) for the sites of a leaf, a lane each.
template <class Visit>
__device__ inline void for_each_site(const VoxelSetView& sites, int64_t leaf, leaf_cooperative::Offsets& shared,
                                     int lane, Visit visit) {
  const int count = leaf_cooperative::list_active(sites.mask[leaf], shared.offset, lane);
  const int64_t first = sites.first[leaf];
  for (int k = lane; k < count; k += 32) visit(int(shared.offset[k]), first + k);
}

}  // namespace sample_cooperative

template <>
struct CooperativeKernel<sample_cooperative::CountMet>
    : leaf_cooperative::CooperativeLeaf<sample_cooperative::CountMet, leaf_cooperative::Offsets> {
  static __device__ void run(const sample_cooperative::CountMet& step, int64_t leaf, Shared& shared, int lane) {
    sample_cooperative::for_each_site(step.of.sites, leaf, shared, lane, [&](int offset, int64_t site) {
      int64_t seen = 0;
      step.of.for_each_triangle(leaf, offset, [&](int64_t) { ++seen; });
      step.count[site] = seen;
    });
  }
};

template <>
struct CooperativeKernel<sample_cooperative::FillMet>
    : leaf_cooperative::CooperativeLeaf<sample_cooperative::FillMet, leaf_cooperative::Offsets> {
  static __device__ void run(const sample_cooperative::FillMet& step, int64_t leaf, Shared& shared, int lane) {
    sample_cooperative::for_each_site(step.of.sites, leaf, shared, lane, [&](int offset, int64_t site) {
      int64_t at = step.first[site];
      step.of.for_each_triangle(leaf, offset, [&](int64_t place) { step.triangles[at++] = step.leaf_triangle[place]; });
    });
  }
};

/// Sorts by counting the smaller ones; long lists by one lane in place.
template <>
struct CooperativeKernel<SortLeafTriangles> : CooperativeKernelOf<SortLeafTriangles> {
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
struct CooperativeKernel<SampleSites> : leaf_cooperative::CooperativeLeaf<SampleSites, leaf_cooperative::Offsets> {
  static __device__ void run(const SampleSites& step, int64_t leaf, Shared& shared, int lane) {
    const Voxel at = leaf_of_key(step.sites.leaf_key[leaf]);
    sample_cooperative::for_each_site(step.sites, leaf, shared, lane, [&](int offset, int64_t site) {
      step.sample[site] = step.nearest(voxel_centre(voxel_at(at, offset)), site);
    });
  }
};

/// The lists of sample_sites_body by way of one mask a leaf and triangle: each pair is tested once, by its own thread.
struct ListSiteTrianglesByMasks {
  static void run(CudaExecutor& exec, const SurfaceView& surface, const VoxelSetView& sites, const LeafTriangles& lists,
                  SiteSamples& out) {
    using namespace sample_cooperative;
    Buffer<LeafMask> met = exec.make<LeafMask>(lists.triangle.size());
    exec.for_each("mark voxels met", met.size(),
                  MarkMet{surface, sites.leaf_key, lists.first.view(), lists.triangle.view(), met.view()});
    const SitesOfLeaf of{sites, lists.first.view(), met.view()};
    exec.for_each("count site triangles", sites.leaf_key.size, CountMet{of, out.first.view()});
    out.triangles = exec.make<uint32_t>(exec.exclusive_scan(out.first.view()));
    exec.for_each("fill site triangles", sites.leaf_key.size,
                  FillMet{of, lists.triangle.view(), out.first.view(), out.triangles.view()});
  }
};

}  // namespace isoshell
