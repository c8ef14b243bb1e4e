// Patches that the short search leaves: the search of all seeds in reach, and two slower ways, all exact, for patches
// with more candidates than their list holds.
#pragma once

#include "cuda/relax/patch_labels.cuh"
#include "voxel/cell_sum.h"

namespace isoshell::cuda_relax {

/// The most that a vertex of a patch pays at the nearest of some winners.
struct MostAtVertices {
  Labelling at;

  __device__ int64_t operator()(const Winners&, int count) const { return label_far(at, count).most; }
};

/// The slow search, for patches that find_near does not do.
__device__ __noinline__ inline SearchResult find_all(Labelling at, int32_t reach) {
  return find_winners(at.pass.search, box_of(at.patch), reach, at.scratch.search, at.scratch.winners,
                      MostAtVertices{at});
}

/// Patches with more candidates than winners: many of them, and no more cells than winners can be.
class ManyCandidates {
 public:
  __device__ explicit ManyCandidates(Labelling at)
      : pass_(at.pass), patch_(at.patch), scratch_(at.scratch), lane_(threadIdx.x & 31) {}

  /// Labels the vertices and gives the winners; false when there are too many of either.
  __device__ bool label_vertices(PatchSearch& search, SearchResult& found) {
    const int count = search.list(found.limit, scratch_.many, kMaxMany);
    if (count > kMaxMany) return false;
    if (lane_ < kMaxMany / 32) scratch_.used[lane_] = 0;
    __syncwarp();
    for (int i = lane_; i < patch_.vertices; i += 32) {
      const int best = nearest(i, scratch_.many, count);
      atomicOr(&scratch_.used[best >> 5], 1u << (best & 31));
    }
    __syncwarp();
    const int used = list_used();
    if (used > kMaxWinners) return false;
    for (int i = lane_; i < patch_.vertices; i += 32) scratch_.label[i] = uint8_t(nearest(i, scratch_.search.id, used));
    __syncwarp();
    search.take(scratch_.search.id, used, scratch_.winners, found);
    return true;
  }

 private:
  /// Number of the seed among these that costs vertex i least, the one with the least id of several.
  __device__ int nearest(int i, const uint32_t* ids, int count) const {
    const Local u = pass_.patches.vertex[patch_.vertex_first + i].local();
    const PointQ8 v = {patch_.bounds.origin.x + u.x, patch_.bounds.origin.y + u.y, patch_.bounds.origin.z + u.z};
    const Normal8 normal = SeedRecord{0, 0, 0, pass_.patches.normal[patch_.vertex_first + i]}.normal();
    int64_t least = INT64_MAX;
    uint32_t best_id = kNone;
    int best = 0;
    for (int c = 0; c < count; ++c) {
      const uint32_t id = ids[c];
      const SeedRecord s = pass_.search.seed[id];
      const int64_t here = distance_sq_q16(v, s.position()) +
                           (dot(normal, s.normal()) < label::kOpposite ? pass_.search.penalty_q16 : 0);
      if (here < least || (here == least && id < best_id)) least = here, best = c, best_id = id;
    }
    return best;
  }

  /// Lists the candidates that label a vertex, as far as they are no more than winners can be. Returns their number.
  __device__ int list_used() {
    int count = 0;
    for (int w = 0; w < kMaxMany / 32; ++w) {
      const uint32_t word = scratch_.used[w];
      const int place = count + lanes_before(word);
      if (word >> lane_ & 1 && place < kMaxWinners) scratch_.search.id[place] = scratch_.many[w * 32 + lane_];
      count += __popc(word);
    }
    __syncwarp();
    return count;
  }

  const SheetPass& pass_;
  const Patch& patch_;
  LabelScratch& scratch_;
  const int lane_;
};

/// The result has more winners than there may be when the patch must be summed directly.
__device__ __noinline__ inline SearchResult label_from_many(Labelling at, SearchResult found) {
  PatchSearch search(at.pass.search, box_of(at.patch), at.scratch.search);
  ManyCandidates(at).label_vertices(search, found);
  return found;
}

/// A patch with more cells than that: each lane labels the corners of its triangles by itself.
__device__ __noinline__ inline Int128 sum_patch_directly(const SheetPass& pass, const Patch& patch, int32_t reach) {
  Int128 energy = 0;
  const PatchBox box = box_of(patch);
  for (int t = int(threadIdx.x & 31); t < patch.triangles; t += 32) {
    const PackedTriangle triangle = pass.patches.triangle[patch.triangle_first + t];
    uint32_t id[3];
    SplitTriangle split;
    split.area2 = triangle.area2;
    for (int i = 0; i < 3; ++i) {
      const int64_t v = patch.vertex_first + triangle.corner(i);
      split.p[i] = pass.patches.vertex[v].local();
      const PointQ8 p = {patch.bounds.origin.x + split.p[i].x, patch.bounds.origin.y + split.p[i].y,
                         patch.bounds.origin.z + split.p[i].z};
      id[i] = patch.has_fixed ? pass.patches.fixed[v] : kNone;
      if (id[i] == kNone)
        id[i] = label_directly(pass.search, box, reach, p, SeedRecord{0, 0, 0, pass.patches.normal[v]}.normal());
      split.s[i] = local(pass.search.seed[id[i]].position(), patch.bounds.origin);
    }
    const auto add = [&](int i, const PieceSum& piece) {
      energy += relax_sheet::add_to_cell(pass.cell[id[i]], piece, split.s[i]);
    };
    if (id[0] == id[1] && id[1] == id[2])
      add(0, piece_sum(split.area2, split.p[0], split.p[1], split.p[2]));
    else if (id[1] == id[2])
      split.two_cells(0, add);
    else if (id[2] == id[0])
      split.two_cells(1, add);
    else if (id[0] == id[1])
      split.two_cells(2, add);
    else
      split.three_cells(add);
  }
  return energy;
}

}  // namespace isoshell::cuda_relax
