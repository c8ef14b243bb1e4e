// Which seeds can be the nearest one of some vertex of a patch, found by one warp: the rule of
// stages/labels/label_body.h (a seed stays out when its smallest cost over the bounds is above the smallest of the
// seeds' largest costs), then a seed also stays out that the best one beats at every vertex.
#pragma once

#include "cuda/relax/box_costs.cuh"

namespace isoshell::cuda_relax {

constexpr int kMaxWinners = 32;  ///< candidates of a patch; more take the exact slow path

/// What a search reads.
struct SeedSearch {
  BucketGrid grid;
  BucketTable table;
  const SeedRecord* seed;
  int64_t penalty_q16;

  /// Of a seed at offset `away` from a vertex.
  __device__ int64_t cost(Local away, uint32_t packed_normal, uint32_t other_normal) const {
    const bool pays = __dp4a(int(packed_normal), int(other_normal), 0) < label::kOpposite;
    return square(away) + (pays ? penalty_q16 : 0);
  }
};

/// Where a candidate is, from the patch's origin.
struct alignas(16) WinnerPlace {
  int32_t x, y, z;
  uint32_t packed_normal;
  __device__ operator Local() const { return {x, y, z}; }
};

/// Candidates of one patch, by ascending id; those that label_paying adds come last.
struct Winners {
  int4 form[kMaxWinners];  ///< |s|^2 - 2 s.v, s and v from the patch's origin: constant, then per x, y and z
  WinnerPlace place[kMaxWinners];
  uint32_t id[kMaxWinners];
};

/// Scratch of the search: numbers of the seeds in 32 full buckets.
struct SearchScratch {
  uint32_t id[32 * kBucketSeeds];
};

struct SearchResult {
  int count;      ///< above kMaxWinners: overflow, and no winners are given
  bool near;      ///< forms hold every cost in 32 bits, penalties apart
  bool narrow;    ///< and there is no penalty to pay
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
    SearchResult result{-1, false, false, INT64_MAX, reach};
    while (BoxCosts<Cost>::fits(box_, result.reach))
      if (look<Cost>(result, out, most_at)) {
        keep<Cost>(out, result);
        break;
      }
    return result;
  }

  /// The quick way, for few seeds near the box: looks once, and not for seeds beyond `reach`. Those stay out rightly
  /// where every label costs at most reach^2; the limit does not promise that. False when it does not do.
  __device__ bool find_near(int32_t reach, Winners& out, SearchResult& result) {
    if (!BoxCosts<uint32_t>::fits(box_, reach)) return false;
    set_reach(reach);
    if (cells_ > kFewCells) return false;
    collect<true>(0);
    if (next_ < cells_ || !add_spilt(reach)) return false;
    const BoxCosts<uint32_t> costs(box_, search_.penalty_q16);
    if (total_ > 32) drop_far(reach);
    if (total_ > 2 * 32) return false;
    constexpr uint32_t kNothing = CostBounds<uint32_t>::none();
    uint32_t id[2] = {kNone, kNone};
    SeedRecord seed[2] = {};
    CostBounds<uint32_t> range[2] = {{kNothing, kNothing, kNothing}, {kNothing, kNothing, kNothing}};
#pragma unroll
    for (int r = 0; r < 2; ++r)
      if (32 * r + lane_ < total_) {
        id[r] = scratch_.id[32 * r + lane_];
        seed[r] = search_.seed[id[r]];
        range[r] = costs.of(seed[r], reach);
      }
    const bool second = range[1].hi < range[0].hi;
    const uint32_t mine = second ? range[1].hi : range[0].hi, least = warp_min(mine);
    if (least == kNothing) return false;
    const int lane = __ffs(int(__ballot_sync(~0u, mine == least))) - 1;
    best_id_ = __shfl_sync(~0u, second ? id[1] : id[0], lane);
    best_may_pay_ = __shfl_sync(~0u, int(second ? range[1].may_oppose : range[0].may_oppose), lane);
    const SeedRecord best = {__shfl_sync(~0u, second ? seed[1].x : seed[0].x, lane),
                             __shfl_sync(~0u, second ? seed[1].y : seed[0].y, lane),
                             __shfl_sync(~0u, second ? seed[1].z : seed[0].z, lane), 0};
    unsigned kept[2];
    bool may_oppose = false;
#pragma unroll
    for (int r = 0; r < 2; ++r) {
      const bool in =
          range[r].lo <= least &&
          (id[r] == best_id_ || !costs.beaten(best, best_id_, best_may_pay_, seed[r], id[r], range[r].always_opposes));
      may_oppose |= in && range[r].may_oppose;
      kept[r] = __ballot_sync(~0u, in);
    }
    result.count = __popc(kept[0]) + __popc(kept[1]);
    if (result.count > kMaxWinners) return false;
    if (kept[0] >> lane_ & 1) put(out, lanes_before(kept[0]), id[0], seed[0]);
    if (kept[1] >> lane_ & 1) put(out, __popc(kept[0]) + lanes_before(kept[1]), id[1], seed[1]);
    result.limit = least;
    result.reach = reach;
    result.narrow = !__any_sync(~0u, may_oppose);
    sort(out, result);
    return true;
  }

  /// Collects all seeds within reach of the box, for `cheapest`. False when there is no room for them.
  __device__ bool gather(int32_t reach) {
    set_reach(reach);
    if (cells_ > kFewCells) return false;
    collect<true>(0);
    return next_ >= cells_ && add_spilt(reach);
  }

  /// The collected seed that costs a vertex least, the first of several: the vertex's place is from the patch's origin.
  __device__ uint32_t cheapest(Local v, uint32_t packed_normal) const {
    int64_t least = INT64_MAX;
    uint32_t best = kNone;
    for (int i = lane_; i < total_; i += 32) {
      const uint32_t id = scratch_.id[i];
      const SeedRecord s = search_.seed[id];
      const Local away = {v.x - (s.x - box_.origin.x), v.y - (s.y - box_.origin.y), v.z - (s.z - box_.origin.z)};
      const int64_t cost = search_.cost(away, s.packed_normal, packed_normal);
      if (cost < least || (cost == least && id < best)) least = cost, best = id;
    }
    const int64_t least_of_all = warp_min(least);
    return warp_min(least == least_of_all ? best : kNone);
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
        const int place = count + lanes_before(kept);
        if (kept >> lane_ & 1 && place < room) ids[place] = id;
        count += __popc(kept);
      }
    });
    __syncwarp();
    return count;
  }

  /// Winners from a list of at most kMaxWinners ids, in its order.
  __device__ void take(const uint32_t* ids, int count, Winners& out, SearchResult& result) const {
    if (lane_ < count) put(out, lane_, ids[lane_], search_.seed[ids[lane_]]);
    result.count = count;
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
    const Cost least = warp_min(best), least_far = warp_min(best_far);
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
        const int place = count + lanes_before(kept);
        if (in && place < kMaxWinners) put(out, place, id, s);
        count += __popc(kept);
      }
    });
    result.reach = reach_of(result.limit);
    result.count = count;
    result.narrow = !__any_sync(~0u, may_oppose);
    if (count <= kMaxWinners) sort(out, result);
  }

  __device__ void put(Winners& out, int place, uint32_t id, const SeedRecord& s) const {
    out.id[place] = id;
    out.place[place] = {s.x - box_.origin.x, s.y - box_.origin.y, s.z - box_.origin.z, s.packed_normal};
  }

  /// By id, with their forms. A seed that is there twice (see collect) stays so.
  __device__ void sort(Winners& out, SearchResult& result) const {
    __syncwarp();
    uint32_t id = kNone;
    WinnerPlace s{0, 0, 0, 0};
    if (lane_ < result.count) {
      id = out.id[lane_];
      s = out.place[lane_];
    }
    int rank = 0;
#pragma unroll 1
    for (int c = 0; c < result.count; ++c) {
      const uint32_t other = __shfl_sync(~0u, id, c);
      rank += other < id || (other == id && c < lane_);
    }
    __syncwarp();  // all have read
    // Forms stay below 3 * 2^28 + 2 * 3 * 2^27.
    const bool near = PatchBox::within(s, 1 << 14);
    if (lane_ < result.count) {
      out.id[rank] = id;
      out.place[rank] = s;
      out.form[rank] =
          near ? make_int4(s.x * s.x + s.y * s.y + s.z * s.z, -2 * s.x, -2 * s.y, -2 * s.z) : make_int4(0, 0, 0, 0);
    }
    result.near = __all_sync(~0u, near) && box_.near();
    result.narrow = result.near && result.narrow;
    __syncwarp();
  }

  /// Calls each(ids, total) until every seed within the reach of the box on every axis was among them, and perhaps
  /// others. All lanes call it.
  template <class Each>
  __device__ void for_each_batch(Each each) {
    for (int base = 0; base < cells_; base = next_) {
      if (base != collected_) collect<false>(base);
      each(scratch_.id, total_);
    }
    if (__any_sync(~0u, has_spilt_)) each(search_.table.spill + 1, int(search_.table.spill[0]));
  }

  static constexpr int kFewCells = 1 << 10;  ///< the most that a quick search looks at

  /// a / b; for few cells by a product that is off by less than what separates such quotients.
  template <bool kFew>
  __device__ static int quotient(int a, int b) {
    return kFew ? int(__fdividef(float(a) + 0.5f, float(b))) : a / b;
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

  /// Numbers of the seeds in cells base .. next_ - 1 of the box, as many as the scratch holds. Hashed cells share
  /// buckets: unless strangers may stay, each seed is met in its own cell only.
  template <bool kStrangers>
  __device__ void collect(int base) {
    __syncwarp();
    total_ = 0;
    next_ = base;
#pragma unroll 1
    while (next_ < cells_ && collect_cells<kStrangers>(next_)) next_ += 32;
    if (!kStrangers && search_.grid.hash_mask) drop_strangers();
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
      const bool near = id != kNone && is_near(id, reach);
      const unsigned lanes = __ballot_sync(~0u, near);
      if (total_ + __popc(lanes) > 32 * kBucketSeeds) return false;
      if (near) scratch_.id[total_ + lanes_before(lanes)] = id;
      total_ += __popc(lanes);
    }
    __syncwarp();
    return true;
  }

  /// Leaves those of the collected seeds that are within reach of the box.
  __device__ void drop_far(int32_t reach) {
    int kept = 0;
#pragma unroll 1
    for (int base = 0; base < total_; base += 32) {
      const bool in = base + lane_ < total_;
      const uint32_t id = in ? scratch_.id[base + lane_] : 0;
      const bool near = in && is_near(id, reach);
      const unsigned lanes = __ballot_sync(~0u, near);
      __syncwarp();  // all have read
      if (near) scratch_.id[kept + lanes_before(lanes)] = id;
      kept += __popc(lanes);
      __syncwarp();
    }
    total_ = kept;
  }

  __device__ uint32_t in_cell(uint32_t id, int x, int y, int z) const {
    return search_.grid.hash_mask && !search_.grid.holds(x, y, z, search_.seed[id].position()) ? kNone : id;
  }

  __device__ void drop_strangers() {
    __syncwarp();
    int kept = 0;
    for (int base = 0; base < total_; base += 32) {
      const uint32_t id = base + lane_ < total_ ? scratch_.id[base + lane_] : kNone;
      const unsigned mine = __ballot_sync(~0u, id != kNone);
      __syncwarp();  // all have read
      if (id != kNone) scratch_.id[kept + lanes_before(mine)] = id;
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
  bool best_may_pay_ = false, has_spilt_ = false;
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
