// Labels of one patch's vertices, by one warp: the numbers of the winners that a search found. The sums of the pass
// read them in a kernel of its own, so that each of the two fits the instruction cache and its registers.
#pragma once

#include "cuda/relax/pass_end.cuh"
#include "cuda/relax/patch_pieces.cuh"
#include "cuda/relax/patch_winners.cuh"
#include "cuda/runtime/staged_copy.cuh"

namespace isoshell::cuda_relax {

/// What labelling leaves to the sums, and to the next pass.
struct alignas(16) PatchWinners {
  uint32_t id[kMaxWinners];
  int32_t count;  ///< 1: the whole patch is its cell's; above kMaxWinners: to be summed directly; then without labels
  int32_t reach;  ///< how far seeds may be that label it
  int32_t unused[2];
};

struct SheetPass {
  PatchesView patches;
  SeedSearch search;
  PatchWinners* winners;
  uint8_t* label;  ///< per vertex of the patches: number of its winner
  int32_t reach_slack;
  relax_sheet::CellSum* cell;
  PassState* state;
  PassProgress* progress;
  int shift;
  int32_t tolerance_ppb;
};

/// Candidates of a crowded patch. Where all its vertices pay for facing away from the seeds around, these are the seeds
/// on both sides of a thin wall, as far as the penalty reaches: some 260 within 4.7 cells.
constexpr int kMaxMany = 480;
static_assert(kMaxMany % 32 == 0 && kMaxMany / 32 <= 32, "a word of LabelScratch::used a lane");

constexpr int kStagedVertices = 256;  ///< that are copied to shared memory; most patches have no more

struct LabelScratch {
  union {
    Winners winners;
    uint32_t many[kMaxMany];  ///< candidates where winners do not hold them
  };
  SearchScratch search;
  uint32_t used[kMaxMany / 32];
  alignas(16) PatchVertex vertex[kStagedVertices];
  uint8_t label[kMaxPatchVertices];
};

/// A patch being labelled.
struct Labelling {
  const SheetPass& pass;
  const Patch& patch;
  LabelScratch& scratch;
};

/// Writes the labels and their winners, of which only those that label a vertex are kept, in their order. Returns how
/// many these are. All lanes give those that label their vertices in `used`.
__device__ inline int write_labels(const Labelling& at, uint32_t used, PatchWinners& out) {
  const int lane = threadIdx.x & 31;
  used = warp_or(used);
  uint8_t* label = at.pass.label + at.patch.vertex_first;
  for (int i = lane; i < at.patch.vertices; i += 32)
    label[i] = uint8_t(__popc(used & ((1u << at.scratch.label[i]) - 1)));
  if (used >> lane & 1) out.id[lanes_before(used)] = at.scratch.winners.id[lane];
  return __popc(used);
}

/// Gives vertices the labels that are prescribed for them: the seeds take the numbers of winners that label no other
/// vertex. Returns all winners that label a vertex then; 0 when they are too many, and the labels of no use.
__device__ __noinline__ inline uint32_t label_fixed(Labelling at) {
  const int lane = threadIdx.x & 31, vertices = at.patch.vertices;
  const uint32_t* fixed = at.pass.patches.fixed + at.patch.vertex_first;
  uint32_t* winner = at.scratch.winners.id;
  uint32_t used = 0;
  for (int i = lane; i < vertices; i += 32)
    if (fixed[i] == kNone) used |= 1u << at.scratch.label[i];
  used = warp_or(used);
  for (int base = 0; base < vertices; base += 32) {
    const uint32_t mine = base + lane < vertices ? fixed[base + lane] : kNone;
    for (unsigned left = __ballot_sync(~0u, mine != kNone); left != 0;) {
      const uint32_t id = __shfl_sync(~0u, mine, __ffs(int(left)) - 1);
      const unsigned same = __ballot_sync(~0u, (used >> lane & 1) != 0 && winner[lane] == id);
      const int number = __ffs(int(same != 0 ? same : ~used)) - 1;
      if (number < 0) return 0;
      __syncwarp();  // all have read
      if (lane == 0) winner[number] = id;
      if (mine == id) at.scratch.label[base + lane] = uint8_t(number);
      __syncwarp();
      used |= 1u << number;
      left &= ~__ballot_sync(~0u, mine == id);
    }
  }
  return used;
}

/// Ends a patch whose labels cost at most `limit` where they are not prescribed. Returns the number of its winners;
/// when prescribed ones are too many it must be summed directly.
__device__ inline int end_labels(const Labelling& at, uint32_t used, int64_t limit, int32_t& reach, PatchWinners& out) {
  if (at.patch.has_fixed) {
    used = label_fixed(at);
    if (used == 0) {
      reach = reach_of(limit);
      return kMaxWinners + 1;
    }
  }
  return write_labels(at, used, out);
}

/// What labelling says of the vertices.
struct Labelled {
  int64_t most;   ///< that one of them pays
  uint32_t used;  ///< winners that label the lane's vertices
};

/// Labels by any distance and penalty; see label_vertices.
__device__ __noinline__ inline Labelled label_far(Labelling at, int count) {
  int64_t most = 0;
  uint32_t used = 0;
  for (int i = int(threadIdx.x & 31); i < at.patch.vertices; i += 32) {
    const int64_t v = at.patch.vertex_first + i;
    const NearestWinner nearest =
        nearest_winner(at.scratch.winners, count, at.pass.patches.vertex[v].local(),
                       SeedRecord{0, 0, 0, at.pass.patches.normal[v]}.normal(), at.pass.search.penalty_q16);
    at.scratch.label[i] = uint8_t(nearest.number);
    used |= 1u << nearest.number;
    most = max(most, nearest.cost);
  }
  return {warp_max(most), used};
}

/// Labels the vertices of a patch with the numbers of its winners, each lane those that it writes.
__device__ inline Labelled label_vertices(const Labelling& at, const SearchResult& found) {
  if (!found.near || (!found.narrow && at.pass.search.penalty_q16 >= kMaxNearPenalty))
    return label_far(at, found.count);
  const PatchVertex* vertex = at.pass.patches.vertex + at.patch.vertex_first;
  const auto vertex_at = [&](int i) { return element_of(at.scratch.vertex, kStagedVertices, vertex, i).local(); };
  const uint32_t* normal = at.pass.patches.normal + at.patch.vertex_first;
  const int lane = threadIdx.x & 31, vertices = at.patch.vertices;
  constexpr int kAtOnce = 4;
  uint32_t most = 0, used = 0;
  for (int base = lane; base - lane < vertices; base += 32 * kAtOnce) {
    Local v[kAtOnce];
    int best[kAtOnce];
    int32_t least[kAtOnce];
#pragma unroll
    for (int r = 0; r < kAtOnce; ++r) v[r] = base + 32 * r < vertices ? vertex_at(base + 32 * r) : Local{0, 0, 0};
    if (found.narrow) {
      winners_at(at.scratch.winners, found.count, v, best, least);
    } else {
      uint32_t n[kAtOnce];
#pragma unroll
      for (int r = 0; r < kAtOnce; ++r) n[r] = base + 32 * r < vertices ? normal[base + 32 * r] : 0;
      winners_at(at.scratch.winners, found.count, v, n, int32_t(at.pass.search.penalty_q16), best, least);
    }
#pragma unroll
    for (int r = 0; r < kAtOnce; ++r)
      if (base + 32 * r < vertices) {
        at.scratch.label[base + 32 * r] = uint8_t(best[r]);
        used |= 1u << best[r];
        most = max(most, uint32_t(least[r]) + square_32(v[r]));
      }
  }
  return {warp_max(most), used};
}

}  // namespace isoshell::cuda_relax
