// Labels of a patch's few vertices that all seeds around face away from, as at the tip of a fin: they pay the penalty,
// and look for a seed on their side as far as that is worth. The others keep the labels of the short search.
#pragma once

#include "cuda/relax/patch_labels.cuh"

namespace isoshell::cuda_relax {

class PayingVertices {
 public:
  /// For labels that were chosen among all seeds within `reach`: right where they cost at most its square.
  __device__ PayingVertices(Labelling at, int winners, int32_t reach)
      : at_(at), winners_(winners), reach_sq_(int64_t(reach) * reach), lane_(threadIdx.x & 31) {}

  /// Labels the vertices that pay more. Returns the most that one of the others pays, and the winners that the lane's
  /// vertices have now; -1 when such vertices, seeds or winners are too many.
  __device__ Labelled label() {
    const Labelled failed{-1, 0};
    PatchBox box = box_of(at_.patch);
    int64_t most = 0;
    if (bound(box, most) > at_.patch.vertices / 4) return failed;
    PatchSearch search(at_.pass.search, box, at_.scratch.search);
    if (!search.gather(reach_of(most))) return failed;
    Labelled out{0, 0};
    for (int base = 0; base < at_.patch.vertices; base += 32) {
      const Vertex v = vertex(base + lane_);
      if (v.cost <= reach_sq_) out.most = max(out.most, v.cost);
      for (unsigned left = __ballot_sync(~0u, v.cost > reach_sq_); left != 0; left &= left - 1) {
        const int from = __ffs(int(left)) - 1;
        const int winner = winner_number(search.cheapest(
            {__shfl_sync(~0u, v.place.x, from), __shfl_sync(~0u, v.place.y, from), __shfl_sync(~0u, v.place.z, from)},
            __shfl_sync(~0u, v.packed_normal, from)));
        if (winner < 0) return failed;
        if (lane_ == from) at_.scratch.label[base + lane_] = uint8_t(winner);
      }
      if (base + lane_ < at_.patch.vertices) out.used |= 1u << at_.scratch.label[base + lane_];
    }
    __syncwarp();
    out.most = warp_max(out.most);
    return out;
  }

 private:
  struct Vertex {
    Local place;
    uint32_t packed_normal;
    int64_t cost;  ///< of its label; none beyond the last vertex
  };
  __device__ Vertex vertex(int i) const {
    if (i >= at_.patch.vertices) return {{0, 0, 0}, 0, 0};
    const int64_t v = at_.patch.vertex_first + i;
    const Local u = at_.pass.patches.vertex[v].local();
    const uint32_t normal = at_.pass.patches.normal[v];
    const WinnerPlace s = at_.scratch.winners.place[at_.scratch.label[i]];
    return {u, normal, at_.pass.search.cost({u.x - s.x, u.y - s.y, u.z - s.z}, s.packed_normal, normal)};
  }

  /// Box of the vertices that pay more, and the most that one pays. Returns how many there are.
  __device__ int bound(PatchBox& box, int64_t& most) const {
    Local lo = box.hi, hi = box.lo;
    int count = 0;
    for (int i = lane_; i < at_.patch.vertices; i += 32) {
      const Vertex v = vertex(i);
      if (v.cost <= reach_sq_) continue;
      lo = {min(lo.x, v.place.x), min(lo.y, v.place.y), min(lo.z, v.place.z)};
      hi = {max(hi.x, v.place.x), max(hi.y, v.place.y), max(hi.z, v.place.z)};
      most = max(most, v.cost);
      ++count;
    }
    box.lo = {warp_min(lo.x), warp_min(lo.y), warp_min(lo.z)};
    box.hi = {warp_max(hi.x), warp_max(hi.y), warp_max(hi.z)};
    most = warp_max(most);
    return warp_sum(count);
  }

  /// Number of a seed among the winners, which it joins; -1 when there is no room.
  __device__ int winner_number(uint32_t id) {
    Winners& winners = at_.scratch.winners;
    const unsigned same = __ballot_sync(~0u, lane_ < winners_ && winners.id[lane_] == id);
    if (same != 0) return __ffs(int(same)) - 1;
    if (winners_ == kMaxWinners) return -1;
    if (lane_ == 0) {
      const SeedRecord s = at_.pass.search.seed[id];
      const PointQ8 o = at_.patch.bounds.origin;
      winners.id[winners_] = id;
      winners.place[winners_] = {s.x - o.x, s.y - o.y, s.z - o.z, s.packed_normal};
    }
    __syncwarp();
    return winners_++;
  }

  const Labelling at_;
  int winners_;
  const int64_t reach_sq_;
  const int lane_;
};

__device__ __noinline__ inline Labelled label_paying(Labelling at, int winners, int32_t reach) {
  return PayingVertices(at, winners, reach).label();
}

}  // namespace isoshell::cuda_relax
