// Seeds in a grid of buckets on the device: filled by one atomic a seed and emptied by the seeds themselves, so a pass
// costs O(seeds) and no scan over cells. What a bucket cannot hold goes to a list that every search reads.
#pragma once

#include "cuda/runtime/executor_cuda.cuh"
#include "voxel/exact_int.h"

namespace isoshell::cuda_relax {

constexpr int kBucketSeeds = 15;
constexpr int64_t kMaxDenseCells = int64_t(1) << 18;

struct alignas(64) SeedBucket {
  uint32_t count;  ///< may pass kBucketSeeds
  uint32_t id[kBucketSeeds];
};

/// A seed as labelling reads it: one 16-byte load.
struct alignas(16) SeedRecord {
  int32_t x, y, z;
  uint32_t packed_normal;

  __device__ PointQ8 position() const { return {x, y, z}; }
  __device__ Normal8 normal() const {
    return {int8_t(packed_normal), int8_t(packed_normal >> 8), int8_t(packed_normal >> 16)};
  }
};
__device__ inline uint32_t pack(Normal8 n) {
  return uint32_t(uint8_t(n.x)) | uint32_t(uint8_t(n.y)) << 8 | uint32_t(uint8_t(n.z)) << 16;
}
__device__ inline SeedRecord seed_record(PointQ8 p, Normal8 n) { return {p.x, p.y, p.z, pack(n)}; }

/// How positions fall into buckets: cells of one edge, numbered densely where they are few, hashed where they are many.
struct BucketGrid {
  uint32_t scale;  ///< floor(2^32 / edge of a cell in q8): cell = coordinate * scale >> 32, monotone
  int32_t dims[3];
  uint32_t hash_mask;  ///< number of buckets less one, or 0: dense

  __device__ int cell(int32_t q8, int axis) const {
    const int c = int(__umulhi(uint32_t(q8 < 0 ? 0 : q8), scale));
    return c < dims[axis] ? c : dims[axis] - 1;
  }
  __device__ uint32_t bucket(int x, int y, int z) const {
    if (hash_mask) return (uint32_t(x) * 73856093u ^ uint32_t(y) * 19349663u ^ uint32_t(z) * 83492791u) & hash_mask;
    return (uint32_t(x) * uint32_t(dims[1]) + uint32_t(y)) * uint32_t(dims[2]) + uint32_t(z);
  }
  __device__ uint32_t bucket_of(PointQ8 p) const { return bucket(cell(p.x, 0), cell(p.y, 1), cell(p.z, 2)); }
  __device__ bool holds(int x, int y, int z, PointQ8 p) const {
    return cell(p.x, 0) == x && cell(p.y, 1) == y && cell(p.z, 2) == z;
  }
};

struct BucketTable {
  SeedBucket* bucket;
  uint32_t* spill;  ///< count, then ids

  __device__ void insert(const BucketGrid& grid, PointQ8 p, uint32_t id) const {
    SeedBucket& b = bucket[grid.bucket_of(p)];
    const uint32_t rank = atomicAdd(&b.count, 1u);
    if (rank < kBucketSeeds)
      b.id[rank] = id;
    else
      spill[1 + atomicAdd(spill, 1u)] = id;
  }
  /// Every seed of the table does this with the position it was inserted at.
  __device__ void remove(const BucketGrid& grid, PointQ8 p, int64_t seed) const {
    bucket[grid.bucket_of(p)].count = 0;
    if (seed == 0) spill[0] = 0;
  }
};

/// Owner. Two tables: one is searched while the next is empty; the seeds move from one to the other.
struct SeedBuckets {
  BucketGrid grid{};
  Buffer<SeedBucket> bucket[2];
  Buffer<uint32_t> spill[2];

  BucketTable table(int which) { return {bucket[which].data(), spill[which].data()}; }
};

/// Cells of edge `edge_q8` over a lattice of this extent, for `seeds` seeds. Empty.
inline SeedBuckets make_seed_buckets(CudaExecutor& exec, const int32_t extent_vox[3], int64_t edge_q8, int64_t seeds,
                                     int tables) {
  SeedBuckets out;
  const int64_t lattice_q8[3] = {int64_t(extent_vox[0]) * kOneVoxelQ8, int64_t(extent_vox[1]) * kOneVoxelQ8,
                                 int64_t(extent_vox[2]) * kOneVoxelQ8};
  int64_t cells = 1;
  for (int axis = 0; axis < 3; ++axis) {
    out.grid.dims[axis] = int32_t(lattice_q8[axis] / edge_q8) + 1;
    cells *= out.grid.dims[axis];
  }
  out.grid.scale = uint32_t((int64_t(1) << 32) / edge_q8);
  int64_t buckets = cells;
  if (cells > kMaxDenseCells) {
    buckets = kMaxDenseCells;
    while (buckets < seeds) buckets *= 2;
    out.grid.hash_mask = uint32_t(buckets - 1);
  }
  for (int t = 0; t < tables; ++t) {
    out.bucket[t] = exec.make<SeedBucket>(buckets);
    out.spill[t] = exec.make<uint32_t>(seeds + 1);
    require_success(cudaMemsetAsync(out.bucket[t].data(), 0, size_t(out.bucket[t].size_bytes()), exec.stream()),
                    "cudaMemsetAsync");
    require_success(cudaMemsetAsync(out.spill[t].data(), 0, sizeof(uint32_t), exec.stream()), "cudaMemsetAsync");
  }
  return out;
}

}  // namespace isoshell::cuda_relax
