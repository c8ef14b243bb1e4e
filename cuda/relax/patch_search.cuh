// Which seeds can be the nearest one of some vertex of a patch, found by one warp: the rule of
// stages/labels/label_body.h (a seed stays out when its smallest cost over the bounds is above the smallest of the
// seeds' largest costs), then a seed also stays out that the best one beats at every vertex.
#pragma once

#include "cuda/relax/seeds_near_box.cuh"

namespace isoshell::cuda_relax {

constexpr int kMaxWinners = 32;  ///< candidates of a patch; more take the exact slow path

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

struct SearchResult {
  int count;      ///< above kMaxWinners: overflow, and no winners are given
  bool near;      ///< forms hold every cost in 32 bits, penalties apart
  bool narrow;    ///< and there is no penalty to pay
  int64_t limit;  ///< no label's cost is above this
  int32_t reach;  ///< how far the search had to look
};

/// The search of one patch by one warp.
class PatchSearch : SeedsNearBox {
 public:
  using SeedsNearBox::SeedsNearBox;

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
    if (!BoxCosts<uint32_t>::fits(box_, reach) || !collect_few(reach)) return false;
    const BoxCosts<uint32_t> costs(box_, search_.penalty_q16);
    const TwoSeeds mine = bound_two(costs, reach);
    uint32_t least;
    SeedRecord best;
    if (!choose_best(mine, least, best) || !keep_two(mine, costs, best, least, out, result)) return false;
    result.limit = least;
    result.reach = reach;
    sort(out, result);
    return true;
  }

  using SeedsNearBox::gather;

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
  /// Collects the seeds around the box, for find_near: at most two a lane. False when there are more.
  __device__ bool collect_few(int32_t reach) {
    if (!gather(reach)) return false;
    if (total_ > 32) drop_far(reach);
    return total_ <= 2 * 32;
  }

  /// The collected seeds of a lane, and what they cost; kNone and no cost where there is none.
  struct TwoSeeds {
    uint32_t id[2];
    SeedRecord seed[2];
    CostBounds<uint32_t> range[2];
  };
  __device__ TwoSeeds bound_two(const BoxCosts<uint32_t>& costs, int32_t reach) const {
    constexpr uint32_t kNothing = CostBounds<uint32_t>::none();
    TwoSeeds mine{{kNone, kNone}, {}, {{kNothing, kNothing, kNothing}, {kNothing, kNothing, kNothing}}};
#pragma unroll
    for (int r = 0; r < 2; ++r)
      if (32 * r + lane_ < total_) {
        mine.id[r] = scratch_.id[32 * r + lane_];
        mine.seed[r] = search_.seed[mine.id[r]];
        mine.range[r] = costs.of(mine.seed[r], reach);
      }
    return mine;
  }

  /// The seed of the smallest largest cost, and that cost. Any of several will do. False when there is no seed.
  __device__ bool choose_best(const TwoSeeds& mine, uint32_t& least, SeedRecord& best) {
    const bool second = mine.range[1].hi < mine.range[0].hi;
    const uint32_t most = second ? mine.range[1].hi : mine.range[0].hi;
    least = warp_min(most);
    if (least == CostBounds<uint32_t>::none()) return false;
    const int lane = __ffs(int(__ballot_sync(~0u, most == least))) - 1;
    best_id_ = __shfl_sync(~0u, second ? mine.id[1] : mine.id[0], lane);
    best_may_pay_ = __shfl_sync(~0u, int(second ? mine.range[1].may_oppose : mine.range[0].may_oppose), lane);
    best = {__shfl_sync(~0u, second ? mine.seed[1].x : mine.seed[0].x, lane),
            __shfl_sync(~0u, second ? mine.seed[1].y : mine.seed[0].y, lane),
            __shfl_sync(~0u, second ? mine.seed[1].z : mine.seed[0].z, lane), 0};
    return true;
  }

  /// Puts down the seeds that the limit leaves and the best one does not beat. False when they are too many.
  __device__ bool keep_two(const TwoSeeds& mine, const BoxCosts<uint32_t>& costs, const SeedRecord& best,
                           uint32_t limit, Winners& out, SearchResult& result) const {
    unsigned kept[2];
    bool may_oppose = false;
#pragma unroll
    for (int r = 0; r < 2; ++r) {
      const CostBounds<uint32_t>& range = mine.range[r];
      const bool in = range.lo <= limit &&
                      (mine.id[r] == best_id_ ||
                       !costs.beaten(best, best_id_, best_may_pay_, mine.seed[r], mine.id[r], range.always_opposes));
      may_oppose |= in && range.may_oppose;
      kept[r] = __ballot_sync(~0u, in);
    }
    result.count = __popc(kept[0]) + __popc(kept[1]);
    if (result.count > kMaxWinners) return false;
    if (kept[0] >> lane_ & 1) put(out, lanes_before(kept[0]), mine.id[0], mine.seed[0]);
    if (kept[1] >> lane_ & 1) put(out, __popc(kept[0]) + lanes_before(kept[1]), mine.id[1], mine.seed[1]);
    result.narrow = !__any_sync(~0u, may_oppose);
    return true;
  }

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
