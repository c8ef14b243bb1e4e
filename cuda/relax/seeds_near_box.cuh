// Collects, by one warp, the seeds within reach of a patch's box from the buckets that hold them. Where the surface is
// cut into patches of its own, only those of the box's are collected: so no limit comes from others.
#pragma once

#include "cuda/relax/box_costs.cuh"

namespace isoshell::cuda_relax {

/// What a search reads.
struct SeedSearch {
  BucketGrid grid;
  BucketTable table;
  const SeedRecord* seed;
  int64_t penalty_q16;
  const uint32_t* patch_of_seed = nullptr;  ///< of the surface; null where it is not cut

  __device__ bool may_label(const PatchBox& box, uint32_t id) const {
    return patch_of_seed == nullptr || patch_of_seed[id] == box.surface_patch;
  }
  /// Of a seed at offset `away` from a vertex.
  __device__ int64_t cost(Local away, uint32_t packed_normal, uint32_t other_normal) const {
    const bool pays = __dp4a(int(packed_normal), int(other_normal), 0) < label::kOpposite;
    return square(away) + (pays ? penalty_q16 : 0);
  }
};

/// Scratch of the search: numbers of the seeds in 32 full buckets.
struct SearchScratch {
  static constexpr int kRoom = 32 * kBucketSeeds;
  uint32_t id[kRoom];
};

/// The seeds within reach of a box, by one warp: all that may be, in batches that fit the scratch.
class SeedsNearBox {
 public:
  __device__ SeedsNearBox(const SeedSearch& search, const PatchBox& box, SearchScratch& scratch)
      : search_(search), box_(box), scratch_(scratch), lane_(threadIdx.x & 31) {}

  /// Collects all seeds within reach of the box, and perhaps others. False when there is no room for them, or cells are
  /// many.
  __device__ bool gather(int32_t reach) {
    set_reach(reach);
    if (cells_ > kFewCells) return false;
    collect<true>(0);
    return next_ >= cells_ && add_spilt(reach);
  }

 protected:
  __device__ void set_reach(int32_t reach) {
    const BucketGrid& g = search_.grid;
    const PointQ8 o = box_.origin;
    first_[0] = g.cell(o.x + box_.lo.x - reach, 0);
    first_[1] = g.cell(o.y + box_.lo.y - reach, 1);
    first_[2] = g.cell(o.z + box_.lo.z - reach, 2);
    const int nx = g.cell(o.x + box_.hi.x + reach, 0) - first_[0] + 1;
    dims_[0] = g.cell(o.y + box_.hi.y + reach, 1) - first_[1] + 1;
    dims_[1] = g.cell(o.z + box_.hi.z + reach, 2) - first_[2] + 1;
    cells_ = nx * dims_[0] * dims_[1];
    collected_ = -1;
  }

  /// Calls each(ids, total) until every seed within the reach of the box on every axis was among them, and perhaps
  /// others. All lanes call it.
  template <class Each>
  __device__ void for_each_batch(Each each) {
    for (int base = 0; base < cells_; base = next_) {
      if (base != collected_) collect<false>(base);
      each(scratch_.id, total_);
    }
    if (!__any_sync(~0u, has_spilt_)) return;
    const bool is_cut = search_.patch_of_seed != nullptr;
    const int spilt = int(search_.table.spill[0]), at_once = is_cut ? SearchScratch::kRoom : spilt;
    for (int base = 0; base < spilt; base += at_once) {
      if (is_cut) collect_spilt(base, min(at_once, spilt - base));
      each(is_cut ? scratch_.id : search_.table.spill + 1, is_cut ? total_ : spilt);
    }
  }

  /// Leaves those of the collected seeds that are within reach of the box.
  __device__ void drop_far(int32_t reach) {
    keep_if([&](uint32_t id) { return is_near(id, reach); });
  }

  const SeedSearch& search_;
  const PatchBox box_;
  SearchScratch& scratch_;
  const int lane_;
  int total_ = 0;  ///< collected seeds, in the scratch

 private:
  static constexpr int kFewCells = 1 << 10;  ///< the most that a quick search looks at

  /// a / b; for few cells by a product that is off by less than what separates such quotients.
  template <bool kFew>
  __device__ static int quotient(int a, int b) {
    return kFew ? int(__fdividef(float(a) + 0.5f, float(b))) : a / b;
  }

  /// Leaves those of the collected seeds that keep(id) is true of.
  template <class Keep>
  __device__ void keep_if(Keep keep) {
    __syncwarp();
    int kept = 0;
#pragma unroll 1
    for (int base = 0; base < total_; base += 32) {
      const bool in = base + lane_ < total_;
      const uint32_t id = in ? scratch_.id[base + lane_] : kNone;
      const bool stays = in && keep(id);
      const unsigned lanes = __ballot_sync(~0u, stays);
      __syncwarp();  // all have read
      if (stays) scratch_.id[kept + lanes_before(lanes)] = id;
      kept += __popc(lanes);
      __syncwarp();
    }
    total_ = kept;
  }
  __device__ void drop_other_patches() {
    keep_if([&](uint32_t id) { return search_.may_label(box_, id); });
  }

  /// Numbers of the seeds in cells base .. next_ - 1 of the box, as many as the scratch holds. Hashed cells share
  /// buckets: unless strangers may stay, each seed is met in its own cell only.
  template <bool kStrangers>
  __device__ void collect(int base) {
    __syncwarp();
    total_ = 0;
    next_ = base;
#pragma unroll 1
    while (next_ < cells_ && collect_cells<kStrangers>(next_)) next_ += 32;
    if (!kStrangers && search_.grid.hash_mask) keep_if([](uint32_t id) { return id != kNone; });
    if (search_.patch_of_seed != nullptr) drop_other_patches();
    collected_ = base;
    __syncwarp();
  }

  /// Adds the seeds of 32 cells; false when there is no room for them.
  template <bool kStrangers>
  __device__ bool collect_cells(int base) {
    int count = 0, x = 0, y = 0, z = 0;
    const uint4* bucket = reinterpret_cast<const uint4*>(search_.table.bucket);
    uint4 part[2] = {};
    if (base + lane_ < cells_) {
      const int c = base + lane_;
      const int row = quotient<kStrangers>(c, dims_[1]);
      z = first_[2] + c - row * dims_[1];
      x = quotient<kStrangers>(row, dims_[0]);
      y = first_[1] + row - x * dims_[0];
      x += first_[0];
      bucket += int64_t(search_.grid.bucket(x, y, z)) * (sizeof(SeedBucket) / sizeof(uint4));
      part[0] = bucket[0];
      part[1] = bucket[1];
      has_spilt_ |= part[0].x > kBucketSeeds;
      count = int(min(part[0].x, uint32_t(kBucketSeeds)));
    }
    const int at = warp_sum_until(count);
    const int added = __shfl_sync(~0u, at, 31);
    if (total_ + added > 32 * kBucketSeeds) return false;
    uint32_t* to = scratch_.id + total_ + at - count;
    total_ += added;
    const auto put = [&](int i, uint32_t id) {
      if (i < count) to[i] = kStrangers ? id : in_cell(id, x, y, z);
    };
    put(0, part[0].y), put(1, part[0].z), put(2, part[0].w);
    put(3, part[1].x), put(4, part[1].y), put(5, part[1].z), put(6, part[1].w);
    if (count > 7) {
      part[0] = bucket[2], part[1] = bucket[3];
      put(7, part[0].x), put(8, part[0].y), put(9, part[0].z), put(10, part[0].w);
      put(11, part[1].x), put(12, part[1].y), put(13, part[1].z), put(14, part[1].w);
    }
    return true;
  }

  __device__ bool is_near(uint32_t id, int32_t reach) const {
    return uint64_t(square(box_.outside(search_.seed[id]))) <= uint64_t(int64_t(reach) * reach);
  }

  /// Adds the seeds within reach of the box that buckets had no room for, where it has such a bucket; false when there
  /// is no room for them.
  __device__ bool add_spilt(int32_t reach) {
    if (!__any_sync(~0u, has_spilt_)) return true;
    const int spilt = int(search_.table.spill[0]);
    for (int base = 0; base < spilt; base += 32) {
      const uint32_t id = base + lane_ < spilt ? search_.table.spill[1 + base + lane_] : kNone;
      const bool near = id != kNone && search_.may_label(box_, id) && is_near(id, reach);
      const unsigned lanes = __ballot_sync(~0u, near);
      if (total_ + __popc(lanes) > 32 * kBucketSeeds) return false;
      if (near) scratch_.id[total_ + lanes_before(lanes)] = id;
      total_ += __popc(lanes);
    }
    __syncwarp();
    return true;
  }

  __device__ uint32_t in_cell(uint32_t id, int x, int y, int z) const {
    return search_.grid.hash_mask && !search_.grid.holds(x, y, z, search_.seed[id].position()) ? kNone : id;
  }

  /// Of the seeds that buckets had no room for, so many from one on, those that may label the box. They take the place
  /// of the seeds that were collected.
  __device__ void collect_spilt(int first, int count) {
    __syncwarp();
    for (int i = lane_; i < count; i += 32) scratch_.id[i] = search_.table.spill[1 + first + i];
    total_ = count;
    collected_ = -1;
    drop_other_patches();
  }

  int first_[3] = {}, dims_[2] = {}, cells_ = 0, collected_ = -1, next_ = 0;
  bool has_spilt_ = false;
};

}  // namespace isoshell::cuda_relax
