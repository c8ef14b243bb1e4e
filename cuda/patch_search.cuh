// Which seeds can be the nearest one of some vertex of a patch, found by one warp: the rule of stages/label_body.h (a
// seed stays out when its smallest cost over the bounds is above the smallest of the seeds' largest costs), then a seed
// also stays out that the best one beats at every vertex.
#pragma once

#include "cuda/box_costs.cuh"

namespace isoshell::cuda_relax {

constexpr int kMaxWinners = 32;  ///< candidates of a patch; more take the exact slow path

/// What a search reads.
struct SeedSearch {
  BucketGrid grid;
  BucketTable table;
  const SeedRecord* seed;
  int64_t penalty_q16;
};

/// Candidates of one patch, by ascending id.
struct Winners {
  int4 form[kMaxWinners];  ///< |s|^2 - 2 s.v, s and v from the patch's origin: constant, then per x, y and z
  Local place[kMaxWinners];
  uint32_t id[kMaxWinners];
  uint32_t packed_normal[kMaxWinners];
};

/// Scratch of the search: numbers of the seeds in 32 full buckets.
struct SearchScratch {
  uint32_t id[32 * kBucketSeeds];
};

struct SearchResult {
  int count;      ///< above kMaxWinners: overflow, and no winners are given
  int best;       ///< place of the best seed among the winners
  bool narrow;    ///< forms hold every cost in 32 bits, no penalty to pay
  int64_t limit;  ///< no label's cost is above this
  int32_t reach;  ///< how far the search had to look
};

/// The search of one patch by one warp.
class PatchSearch {
 public:
  __device__ PatchSearch(const SeedSearch& search, const PatchBox& box, SearchScratch& scratch)
      : search_(search), box_(box), scratch_(scratch), lane_(threadIdx.x & 31) {}

  /// Looks `reach` far first. Cost must fit; the result has count -1 when it no longer does. `most_at(winners)` is the
  /// most that a vertex pays at the nearest of some winners.
  template <class Cost, class Most>
  __device__ SearchResult find(int32_t reach, Winners& out, Most most_at) {
    SearchResult result{-1, 0, false, INT64_MAX, reach};
    while (BoxCosts<Cost>::fits(box_, result.reach))
      if (look<Cost>(result, out, most_at)) {
        keep<Cost>(out, result);
        break;
      }
    return result;
  }

  /// Again with a limit that is known to hold. Returns the number of candidates; writes their ids to `ids` as far as
  /// `room` goes.
  __device__ int list(int64_t limit, uint32_t* ids, int room) {
    const int32_t reach = reach_of(limit);
    const BoxCosts<int64_t> costs(box_, search_.penalty_q16);
    int count = 0;
    set_reach(reach);
    for_each_batch([&](const uint32_t* batch, int total) {
      for (int base = 0; base < total; base += 32) {
        const bool in = base + lane_ < total;
        const uint32_t id = in ? batch[base + lane_] : 0;
        const unsigned kept = __ballot_sync(~0u, in && costs.of(search_.seed[id], reach).lo <= limit);
        const int place = count + __popc(kept & ((1u << lane_) - 1));
        if (kept >> lane_ & 1 && place < room) ids[place] = id;
        count += __popc(kept);
      }
    });
    __syncwarp();
    return count;
  }

  /// Winners from a list of at most kMaxWinners ids, in its order. The best is any.
  __device__ void take(const uint32_t* ids, int count, Winners& out, SearchResult& result) const {
    if (lane_ < count) put(out, lane_, ids[lane_], search_.seed[ids[lane_]]);
    result.count = count;
    result.best = 0;
    __syncwarp();
  }

 private:
  /// The limit, by what seeds cost at most. False when the reach was too short; then it is longer.
  template <class Cost, class Most>
  __device__ bool look(SearchResult& result, Winners& out, Most most_at) {
    const int32_t reach = result.reach;
    const BoxCosts<Cost> costs(box_, search_.penalty_q16);
    Cost best = CostBounds<Cost>::none(), best_far = best;
    best_id_ = kNone;
    best_may_pay_ = false;
    set_reach(reach);
    for_each_batch([&](const uint32_t* batch, int total) {
      for (int i = lane_; i < total; i += 32) {
        const uint32_t id = batch[i];
        const CostBounds<Cost> range = costs.of(search_.seed[id], reach);
        best_far = min(best_far, range.far);
        if (range.hi < best) best = range.hi, best_id_ = id, best_may_pay_ = range.may_oppose;
      }
    });
    const Cost least = min_over_warp(best), least_far = min_over_warp(best_far);
    // Any of the best will do.
    const int lane = __ffs(int(__ballot_sync(~0u, best == least))) - 1;
    best_id_ = __shfl_sync(~0u, best_id_, lane);
    best_may_pay_ = __shfl_sync(~0u, int(best_may_pay_), lane);
    const int64_t reach_sq = int64_t(reach) * reach;
    if (least != CostBounds<Cost>::none()) result.limit = min(result.limit, int64_t(least));
    if (least_far < least && int64_t(least_far) <= reach_sq) tighten(result, least_far, out, most_at);
    if (result.limit <= reach_sq) return true;
    result.reach = result.limit == INT64_MAX ? 2 * reach : reach_of(result.limit);
    return false;
  }

  /// Where normals point all ways, any seed may have to pay; then the limit is what vertices pay at the seeds around.
  template <class Cost, class Most>
  __device__ void tighten(SearchResult& result, Cost least_far, Winners& out, Most most_at) {
    SearchResult around = result;
    around.limit = int64_t(least_far);
    keep<Cost>(out, around);
    if (around.count > 0 && around.count <= kMaxWinners) result.limit = min(result.limit, most_at(out, around.count));
    __syncwarp();
  }

  /// The seeds that the limit leaves and the best one does not beat. The box is that of the last look.
  template <class Cost>
  __device__ void keep(Winners& out, SearchResult& result) {
    const int32_t reach = result.reach;
    const BoxCosts<Cost> costs(box_, search_.penalty_q16);
    const bool has_best = best_id_ != kNone;
    const SeedRecord best = search_.seed[has_best ? best_id_ : 0];
    int count = 0;
    bool may_oppose = false;
    for_each_batch([&](const uint32_t* batch, int total) {
      for (int base = 0; base < total; base += 32) {
        bool in = base + lane_ < total;
        const uint32_t id = in ? batch[base + lane_] : 0;
        const SeedRecord s = search_.seed[id];
        const CostBounds<Cost> range = costs.of(s, reach);
        in = in && range.lo <= Cost(result.limit) &&
             (!has_best || id == best_id_ || !costs.beaten(best, best_id_, best_may_pay_, s, id, range.always_opposes));
        may_oppose |= in && range.may_oppose;
        const unsigned kept = __ballot_sync(~0u, in);
        const int place = count + __popc(kept & ((1u << lane_) - 1));
        if (in && place < kMaxWinners) put(out, place, id, s);
        count += __popc(kept);
      }
    });
    result.reach = reach_of(result.limit);
    result.count = count;
    result.narrow = !__any_sync(~0u, may_oppose) && box_.near();
    if (count <= kMaxWinners) sort(best_id_, out, result);
  }

  __device__ void put(Winners& out, int place, uint32_t id, const SeedRecord& s) const {
    out.id[place] = id;
    out.place[place] = {s.x - box_.origin.x, s.y - box_.origin.y, s.z - box_.origin.z};
    out.packed_normal[place] = s.packed_normal;
  }

  /// By id, with their forms.
  __device__ void sort(uint32_t best_id, Winners& out, SearchResult& result) const {
    __syncwarp();
    uint32_t id = kNone, packed_normal = 0;
    Local s{0, 0, 0};
    if (lane_ < result.count) {
      id = out.id[lane_];
      packed_normal = out.packed_normal[lane_];
      s = out.place[lane_];
    }
    int rank = 0;
    for (int c = 0; c < result.count; ++c) rank += __shfl_sync(~0u, id, c) < id;
    __syncwarp();
    // Forms stay below 3 * 2^28 + 2 * 3 * 2^27.
    const bool near = PatchBox::within(s, 1 << 14);
    if (lane_ < result.count) {
      out.id[rank] = id;
      out.packed_normal[rank] = packed_normal;
      out.place[rank] = s;
      out.form[rank] =
          near ? make_int4(s.x * s.x + s.y * s.y + s.z * s.z, -2 * s.x, -2 * s.y, -2 * s.z) : make_int4(0, 0, 0, 0);
    }
    result.narrow = __all_sync(~0u, near) && result.narrow;
    const unsigned is_best = __ballot_sync(~0u, lane_ < result.count && id == best_id);
    result.best = is_best ? __shfl_sync(~0u, rank, __ffs(int(is_best)) - 1) : 0;
    __syncwarp();
  }

  /// Calls each(ids, total) until every seed within the reach of the box on every axis was among them, and perhaps
  /// others. All lanes call it.
  template <class Each>
  __device__ void for_each_batch(Each each) {
    for (int base = 0; base < cells_; base = next_) {
      if (base != collected_) collect(base);
      each(scratch_.id, total_);
    }
    if (const uint32_t spilt = search_.table.spill[0]) each(search_.table.spill + 1, int(spilt));
  }

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

  /// Numbers of the seeds in cells base .. next_ - 1 of the box, as many as the scratch holds.
  __device__ void collect(int base) {
    __syncwarp();
    total_ = 0;
    next_ = base;
    while (next_ < cells_ && collect_cells(next_)) next_ += 32;
    if (search_.grid.hash_mask) drop_strangers();
    collected_ = base;
    __syncwarp();
  }

  /// Adds the seeds of 32 cells; false when there is no room for them.
  __device__ bool collect_cells(int base) {
    int count = 0, x = 0, y = 0, z = 0;
    const uint4* bucket = reinterpret_cast<const uint4*>(search_.table.bucket);
    uint4 part[2] = {};
    if (base + lane_ < cells_) {
      const int c = base + lane_;
      const int row = c / dims_[1];
      z = first_[2] + c - row * dims_[1];
      x = row / dims_[0];
      y = first_[1] + row - x * dims_[0];
      x += first_[0];
      bucket += int64_t(search_.grid.bucket(x, y, z)) * (sizeof(SeedBucket) / sizeof(uint4));
      part[0] = bucket[0];
      part[1] = bucket[1];
      count = int(min(part[0].x, uint32_t(kBucketSeeds)));
    }
    int at = count;
    for (int d = 1; d < 32; d <<= 1) {
      const int before = __shfl_up_sync(~0u, at, d);
      if (lane_ >= d) at += before;
    }
    const int added = __shfl_sync(~0u, at, 31);
    if (total_ + added > 32 * kBucketSeeds) return false;
    uint32_t* to = scratch_.id + total_ + at - count;
    total_ += added;
    const auto put = [&](int i, uint32_t id) {
      if (i < count) to[i] = in_cell(id, x, y, z);
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

  /// Hashed cells share buckets: each seed is met in its own cell only.
  __device__ uint32_t in_cell(uint32_t id, int x, int y, int z) const {
    return search_.grid.hash_mask && !search_.grid.holds(x, y, z, search_.seed[id].position()) ? kNone : id;
  }

  __device__ void drop_strangers() {
    __syncwarp();
    int kept = 0;
    for (int base = 0; base < total_; base += 32) {
      const uint32_t id = base + lane_ < total_ ? scratch_.id[base + lane_] : kNone;
      const unsigned mine = __ballot_sync(~0u, id != kNone);
      if (id != kNone) scratch_.id[kept + __popc(mine & ((1u << lane_) - 1))] = id;
      kept += __popc(mine);
      __syncwarp();
    }
    total_ = kept;
  }

  const SeedSearch& search_;
  const PatchBox box_;
  SearchScratch& scratch_;
  const int lane_;
  int first_[3] = {}, dims_[2] = {}, cells_ = 0, collected_ = -1, next_ = 0, total_ = 0;
  uint32_t best_id_ = 0;
  bool best_may_pay_ = false;
};

template <class Most>
__device__ __noinline__ SearchResult find_far(const SeedSearch& search, PatchBox box, int32_t reach,
                                              SearchScratch& scratch, Winners& out, Most most_at) {
  return PatchSearch(search, box, scratch).find<int64_t>(reach, out, most_at);
}

/// The winners of a patch.
template <class Most>
__device__ inline SearchResult find_winners(const SeedSearch& search, const PatchBox& box, int32_t reach,
                                            SearchScratch& scratch, Winners& out, Most most_at) {
  const SearchResult near = PatchSearch(search, box, scratch).find<uint32_t>(reach, out, most_at);
  return near.count >= 0 ? near : find_far(search, box, near.reach, scratch, out, most_at);
}

}  // namespace isoshell::cuda_relax
