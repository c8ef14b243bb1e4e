// One pass of relax_on_sheet in two kernels: sum_patches (candidates, labels, clipped cells, their sums; the last block
// ends the pass as FinishPass does) and move_seeds (to the centre, then ahead for the next pass, into the other table).
// Definition and arithmetic are those of stages/relax_sheet_body.h; labels are never stored.
#pragma once

#include "cuda/crowded_patch.cuh"
#include "cuda/group_walk.cuh"

namespace isoshell::cuda_relax {

/// Blocks of one warp that sum on a multiprocessor at once; with 24, a thread has at most 80 registers. Some chips hold
/// no more than 16.
#if !defined(__CUDA_ARCH__) || __CUDA_ARCH__ == 800 || __CUDA_ARCH__ >= 890
constexpr int kSumBlocks = 24;
#else
constexpr int kSumBlocks = 16;
#endif
constexpr int kMoveThreads = 64;

/// One warp's patch; returns the lane's part of the energy.
__device__ inline Int128 sum_patch(const SheetPass& pass, int64_t number, WarpScratch& scratch) {
  const Patch& patch = pass.patches.patch[number];
  if (patch.triangles == 0) return 0;
  const int lane = threadIdx.x & 31;
  SearchResult found;
  int32_t reach = pass.reach[number];
  for (;;) {
    if (!PatchSearch(pass.search, box_of(patch), scratch.search).find_near(reach, scratch.winners, found))
      found = find_all(pass, patch, reach, scratch);
    const int64_t reach_sq = int64_t(found.reach) * found.reach;
    if (found.count == 1 && found.limit <= reach_sq)
      return lane == 0 ? in_patch::add_to_cell(pass.cell[scratch.winners.id[0]], patch.total, scratch.winners.place[0])
                       : Int128(0);
    if (found.count > kMaxWinners) {
      found = label_from_many(pass, patch, found, scratch);
      if (lane == 0) pass.reach[number] = found.reach + pass.reach_slack;
      if (found.count > kMaxWinners) return sum_patch_directly(pass, patch, found.limit);
      break;
    }
    const int64_t most = label_vertices(pass, patch, found, scratch);
    reach = reach_of(most);
    if (lane == 0) pass.reach[number] = reach + pass.reach_slack;
    if (most <= reach_sq) break;
  }
  return PatchSums(pass, patch, found.count, scratch).add_to_cells();
}

/// Each warp takes patches until there are none: some take much longer than others.
__global__ void __launch_bounds__(32, kSumBlocks) sum_patches(const __grid_constant__ SheetPass pass) {
  __shared__ WarpScratch scratch;
  __shared__ Int128 energy[32];
  if (pass_is_over(pass.state, pass.progress)) return;
  energy[threadIdx.x] = 0;
  for (uint32_t number = blockIdx.x, taken = 0; number < pass.patches.count;
       number = gridDim.x + __shfl_sync(kWholeWarp, taken, 0)) {
    if (threadIdx.x == 0) taken = atomicAdd(&pass.progress->patches_taken, 1u);
    energy[threadIdx.x] += sum_patch(pass, number, scratch);
  }
  end_block<1>(pass.progress, energy[threadIdx.x], [&](View<const int64_t> total) {
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

/// floor(n / d) for d > 0 and quotients below 2^50: the rounded quotient is off by at most one.
__device__ inline int64_t short_floor_div(int64_t n, int64_t d) {
  const int64_t q = __double2ll_rd(double(n) / double(d)), rest = n - q * d;
  return rest < 0 ? q - 1 : rest >= d ? q + 1 : q;
}

/// The way from a seed to its cell's centre (see relax_sheet::way_to_centre), by a group of lanes with the same
/// arguments: each divides for one component.
__device__ inline Vec64 way_together(const relax_sheet::CellSum& cell) {
  const int component = threadIdx.x & 3, group = threadIdx.x & 31 & ~(kWalkLanes - 1);
  const int64_t first = component == 0 ? cell.first_x : component == 1 ? cell.first_y : cell.first_z;
  const int64_t three = 3 * cell.mass;
  const int64_t way = cell.mass > 0 ? short_floor_div(2 * first + three, 2 * three) : 0;
  return {__shfl_sync(~0u, way, group), __shfl_sync(~0u, way, group + 1), __shfl_sync(~0u, way, group + 2)};
}

/// MovingSeeds::moved, for a seed at home at a vertex.
__device__ inline PointQ8 moved_by(const relax_sheet::MovingSeeds& seeds, uint32_t home, PointQ8 from, Vec64 step) {
  const int64_t length_sq = dot(step, step), most = seeds.lengths.scaled(seeds.max_step_q8, home);
  if (length_sq > most * most) {
    const int64_t length = int64_t(isqrt(uint64_t(length_sq))) + 1;
    const auto shorter = [&](int64_t s) {
      const int64_t size = short_floor_div((s < 0 ? -s : s) * most, length);
      return s < 0 ? -size : size;
    };
    step = {shorter(step.x), shorter(step.y), shorter(step.z)};
  }
  return {from.x + int32_t(step.x), from.y + int32_t(step.y), from.z + int32_t(step.z)};
}

/// Everything a seed does between two sums, by a group of lanes a seed: the way to the centre, and on ahead.
__global__ void __launch_bounds__(kMoveThreads) move_seeds(const __grid_constant__ SheetMove move) {
  if (!move.progress->moving) return;
  const int64_t thread = int64_t(blockIdx.x) * blockDim.x + threadIdx.x;
  const bool exists = thread / kWalkLanes < move.count;
  const int64_t i = exists ? thread / kWalkLanes : 0;
  const relax_sheet::MovingSeeds& seeds = move.seeds;
  const bool goes_on = !move.state->converged && move.state->passes < move.max_passes;
  const int64_t beta_q15 = move.state->beta_q15;
  const PointQ8 before = seeds.here[i], last = seeds.last[i];
  const relax_sheet::CellSum cell = move.cell[i];
  Landing at{seeds.home[i], before};
  PointQ8 centre = before;
  Vec64 step = way_together(cell);
  bool active = exists && cell.mass > 0, moved = active;
  const int legs = goes_on && beta_q15 != 0 ? 2 : 1;
#pragma unroll 1
  for (int leg = 0; leg < legs; ++leg) {
    if (leg == 1) {
      step = difference(centre, last) * beta_q15;
      step = {step.x >> 15, step.y >> 15, step.z >> 15};
      active = moved = exists;
    }
    const Landing landing = walk_together(seeds.walk, at.vertex, moved_by(seeds, at.vertex, at.point, step), active);
    if (active) at = landing;
    if (leg == 0) centre = at.point;
  }
  __syncwarp();
  if (!exists || thread % kWalkLanes != 0) return;
  const Normal8 normal = seeds.walk.normal[at.vertex];
  move.from.remove(move.grid, before, i);
  move.cell[i] = {0, 0, 0, 0};
  if (goes_on) {
    seeds.last[i] = centre;
    move.to.insert(move.grid, at.point, uint32_t(i));
    move.record[i] = seed_record(at.point, normal);
  }
  if (!moved) return;
  seeds.here[i] = at.point;
  seeds.home[i] = at.vertex;
  seeds.normal[i] = normal;
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

}  // namespace isoshell::cuda_relax
