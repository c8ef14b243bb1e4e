// One pass of relax_on_sheet in two kernels: sum_patches (candidates, labels, clipped cells, their sums; the last block
// ends the pass as FinishPass does) and move_seeds (to the centre, then ahead for the next pass, into the other table).
// Definition and arithmetic are those of stages/relax_sheet_body.h; labels are never stored.
#pragma once

#include "cuda/crowded_patch.cuh"
#include "cuda/group_walk.cuh"

namespace isoshell::cuda_relax {

constexpr int kSumWarps = 2;    ///< few, since a block lasts as long as its slowest patch
constexpr int kSumBlocks = 16;  ///< a multiprocessor: at most 64 registers a thread
constexpr int kMoveThreads = 64;

/// One warp's patch; returns the lane's part of the energy.
__device__ inline Int128 sum_patch(const SheetPass& pass, int64_t leaf, WarpScratch& scratch) {
  const Patch& patch = pass.patches.patch[leaf];
  if (patch.triangles == 0) return 0;
  const int lane = threadIdx.x & 31;
  SearchResult found = find_winners(pass.search, box_of(patch), pass.reach[leaf], scratch.search, scratch.winners,
                                    MostAtVertices{&pass, leaf});
  if (lane == 0) pass.reach[leaf] = found.reach + pass.reach_slack;
  const bool many = found.count > kMaxWinners;
  if (many) found = label_from_many(pass, leaf, found, scratch);
  if (found.count > kMaxWinners) return sum_patch_directly(pass, leaf, found.limit);
  if (found.count == 1)
    return lane == 0 ? relax_sheet::add_to_cell(pass.cell[scratch.winners.id[0]], patch.total, scratch.winners.place[0])
                     : Int128(0);
  PatchSums sums(pass, patch, found, scratch);
  if (!many) sums.label_vertices();
  sums.sum_triangles();
  return sums.flush();
}

__global__ void __launch_bounds__(kSumWarps * 32, kSumBlocks) sum_patches(const __grid_constant__ SheetPass pass) {
  __shared__ WarpScratch scratch[kSumWarps];
  if (pass_is_over(pass.state, pass.progress)) return;
  const int64_t leaf = int64_t(blockIdx.x) * kSumWarps + (threadIdx.x >> 5);
  Int128 energy = 0;
  if (leaf < pass.patches.count) energy = sum_patch(pass, leaf, scratch[threadIdx.x >> 5]);
  end_block<kSumWarps>(pass.progress, energy, [&](View<const int64_t> total) {
    relax_sheet::FinishPass{{pass.state, 1}, total, pass.shift, pass.tolerance_ppb}(0);
  });
}

struct SheetMove {
  relax_sheet::MovingSeeds seeds;
  relax_sheet::CellSum* cell;
  SeedRecord* record;
  BucketGrid grid;
  BucketTable from, to;
  const PassState* state;
  const PassProgress* progress;
  int32_t max_passes;
  int64_t count;
};

/// point_towards_centre by a group of lanes with the same arguments: each divides for one component.
__device__ inline PointQ8 towards_centre_together(const relax_sheet::MovingSeeds& seeds,
                                                  const relax_sheet::CellSum& cell, PointQ8 here) {
  const int component = threadIdx.x & 3, group = threadIdx.x & 31 & ~(kWalkLanes - 1);
  const int64_t first = component == 0 ? cell.first_x : component == 1 ? cell.first_y : cell.first_z;
  const int64_t way = cell.mass > 0 ? relax_sheet::way_to_centre(first, cell.mass) : 0;
  return seeds.moved(
      here, {__shfl_sync(~0u, way, group), __shfl_sync(~0u, way, group + 1), __shfl_sync(~0u, way, group + 2)});
}

/// Everything a seed does between two sums, by a group of lanes a seed.
__global__ void __launch_bounds__(kMoveThreads) move_seeds(const __grid_constant__ SheetMove move) {
  if (!move.progress->moving) return;
  const int64_t thread = int64_t(blockIdx.x) * blockDim.x + threadIdx.x;
  const bool exists = thread / kWalkLanes < move.count;
  const int64_t i = exists ? thread / kWalkLanes : 0;
  const bool writes = exists && thread % kWalkLanes == 0;
  const relax_sheet::MovingSeeds& seeds = move.seeds;
  const PointQ8 before = seeds.here[i];
  const relax_sheet::CellSum cell = move.cell[i];
  const bool has_area = cell.mass > 0;
  Landing at{seeds.home[i], before};
  bool moved = exists && has_area;
  const Landing centre = walk_together(seeds.walk, at.vertex, towards_centre_together(seeds, cell, before), moved);
  if (moved) at = centre;
  __syncwarp();
  if (writes) {
    move.from.remove(move.grid, before, i);
    move.cell[i] = {0, 0, 0, 0};
  }
  if (!move.state->converged && move.state->passes < move.max_passes) {
    const int64_t beta_q15 = move.state->beta_q15;
    const PointQ8 s = at.point;
    if (beta_q15 != 0) {
      const Landing ahead =
          walk_together(seeds.walk, at.vertex, relax_sheet::point_ahead(seeds, s, beta_q15, i), exists);
      at = ahead;
      moved = true;
    }
    __syncwarp();
    if (writes) {
      seeds.last[i] = s;
      move.to.insert(move.grid, at.point, uint32_t(i));
      move.record[i] = seed_record(at.point, seeds.walk.normal[at.vertex]);
    }
  }
  if (!writes || !moved) return;
  seeds.here[i] = at.point;
  seeds.home[i] = at.vertex;
  seeds.normal[i] = seeds.walk.normal[at.vertex];
}

/// Before the first pass, which looks ahead nowhere.
__global__ void start_seeds(SheetMove move, PassState* state, PassProgress* progress) {
  const int64_t i = int64_t(blockIdx.x) * blockDim.x + threadIdx.x;
  if (i == 0) {
    relax_sheet::StartPasses{{state, 1}}(0);
    *progress = PassProgress{};
  }
  if (i >= move.count) return;
  const PointQ8 p = move.seeds.here[i];
  move.seeds.last[i] = p;
  move.cell[i] = {0, 0, 0, 0};
  move.to.insert(move.grid, p, uint32_t(i));
  move.record[i] = seed_record(p, move.seeds.normal[i]);
}

__global__ void first_reach(PatchesView patches, int64_t h_q8, int32_t* reach) {
  const int64_t leaf = int64_t(blockIdx.x) * blockDim.x + threadIdx.x;
  if (leaf >= patches.count) return;
  const label::Bounds b = patches.patch[leaf].bounds();
  reach[leaf] = reach_of(distance_sq_q16(b.lo, b.hi)) + int32_t(h_q8 * 3 / 4);
}

}  // namespace isoshell::cuda_relax
