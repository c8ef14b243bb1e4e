// One pass of relax_on_sheet in three kernels: label_patches (candidates, labels), sum_patches (clipped cells and their
// sums; the last block ends the pass as FinishPass does) and move_seeds (to the centre, then ahead for the next pass,
// into the other table). Definition and arithmetic are those of stages/relax/relax_sheet_body.h.
#pragma once

#include "cuda/relax/crowded_patch.cuh"
#include "cuda/relax/group_walk.cuh"
#include "cuda/relax/patch_queue.cuh"
#include "cuda/relax/patch_sums.cuh"
#include "cuda/relax/paying_vertices.cuh"
#include "cuda/runtime/dependent_launch.cuh"

namespace isoshell::cuda_relax {

/// Blocks that a multiprocessor holds at most: kernels do not ask for more. Some chips hold fewer.
#if defined(__CUDA_ARCH__) && (__CUDA_ARCH__ < 800 || __CUDA_ARCH__ == 860 || __CUDA_ARCH__ == 870)
constexpr int kMostBlocks = 16;
#elif defined(__CUDA_ARCH__) && (__CUDA_ARCH__ == 890 || __CUDA_ARCH__ >= 1200)
constexpr int kMostBlocks = 24;
#else
constexpr int kMostBlocks = 32;
#endif
constexpr int at_once(int blocks) { return blocks < kMostBlocks ? blocks : kMostBlocks; }
constexpr int kMoveThreads = 64;

/// Labels one patch; returns the number of its winners (see PatchWinners).
__device__ inline int label_patch(const Labelling& at, int32_t& reach, PatchWinners& out) {
  for (;;) {
    SearchResult found;
    if (!PatchSearch(at.pass.search, box_of(at.patch), at.scratch.search).find_near(reach, at.scratch.winners, found))
      found = find_all(at, reach);
    const int64_t reach_sq = int64_t(found.reach) * found.reach;
    if (found.count == 1 && found.limit <= reach_sq && !at.patch.has_fixed) {
      reach = reach_of(found.limit);
      if ((threadIdx.x & 31) == 0) out.id[0] = at.scratch.winners.id[0];
      return 1;
    }
    if (found.count > kMaxWinners) {
      found = label_from_many(at, found);
      if (found.count > kMaxWinners) {
        reach = reach_of(found.limit);
        return found.count;
      }
      reach /= 2;  // most likely for vertices that pay: in some passes the short search does for the others
      return end_labels(at, ~0u >> (32 - found.count), found.limit, reach, out);
    }
    const Labelled labelled = label_vertices(at, found);
    const int64_t penalty = at.pass.search.penalty_q16;
    if (penalty > 0 && labelled.most >= penalty && labelled.most > reach_sq) {
      const Labelled paying = label_paying(at, found.count, found.reach);
      if (paying.most >= 0) {
        reach = reach_of(paying.most);
        return end_labels(at, paying.used, labelled.most, reach, out);
      }
    }
    reach = reach_of(labelled.most);
    if (labelled.most <= reach_sq) return end_labels(at, labelled.used, labelled.most, reach, out);
  }
}

/// kBlocks: how many work on a multiprocessor at once.
template <int kBlocks>
__global__ void __launch_bounds__(32, at_once(kBlocks)) label_patches(const __grid_constant__ SheetPass pass) {
  __shared__ PatchQueue::Room room;
  __shared__ LabelScratch scratch;
  wait_for_earlier_kernels();
  if (pass_is_over(pass.state, pass.progress)) return;
  for (PatchQueue queue(pass, pass.progress->patches_labelled, room); queue.has_patch(); queue.go_on()) {
    const int64_t number = queue.number();
    const Patch& patch = queue.patch();
    start_copy(scratch.vertex, pass.patches.vertex + patch.vertex_first, min(int(patch.vertices), kStagedVertices));
    const uint32_t next = queue.take();
    wait_for_copies();
    queue.start(next);
    int32_t reach = queue.winners().reach;
    PatchWinners& out = pass.winners[number];
    const int winners = patch.triangles == 0 ? 0 : label_patch({pass, patch, scratch}, reach, out);
    if (threadIdx.x == 0) {
      out.count = winners;
      out.reach = reach + pass.reach_slack;
    }
  }
}

/// Adds the sums of one labelled patch to its cells, and to the lanes' energies.
template <bool kHold>
__device__ inline void sum_patch(const SheetPass& pass, PatchQueue& queue, SumScratch& scratch) {
  const Patch& patch = queue.patch();
  const PatchWinners& winners = queue.winners();
  const int lane = threadIdx.x;
  PatchSums<kHold> sums(pass, patch, winners, scratch);
  const bool has_labels = winners.count > 1 && winners.count <= kMaxWinners;
  // All that is read of the patch is on the way before any of it is waited for.
  if (has_labels) sums.start_copies();
  const uint32_t next = queue.take();
  const bool is_winner = lane < winners.count && winners.count <= kMaxWinners;
  const SeedRecord seed = is_winner ? pass.search.seed[winners.id[lane]] : SeedRecord{};
  if (has_labels) sums.load_owned();
  if (is_winner) {
    const PointQ8 o = patch.bounds.origin;
    scratch.place[lane] = {seed.x - o.x, seed.y - o.y, seed.z - o.z, seed.packed_normal};
  }
  wait_for_copies();
  queue.start(next);
  if (has_labels)
    sums.add_to_cells();
  else if (winners.count > kMaxWinners)
    scratch.energy[lane] += sum_patch_directly(pass, patch, winners.reach);
  else if (winners.count == 1 && lane == 0)
    scratch.energy[0] += in_patch::add_to_cell(pass.cell[winners.id[0]], patch.total, scratch.place[0]);
}

template <int kBlocks>
__global__ void __launch_bounds__(32, at_once(kBlocks)) sum_patches(const __grid_constant__ SheetPass pass) {
  __shared__ PatchQueue::Room room;
  __shared__ SumScratch scratch;
  wait_for_earlier_kernels();
  if (pass_is_over(pass.state, pass.progress)) return;
  scratch.energy[threadIdx.x] = 0;
  for (PatchQueue queue(pass, pass.progress->patches_summed, room); queue.has_patch(); queue.go_on())
    sum_patch<kBlocks <= 16>(pass, queue, scratch);
  end_block<1>(pass.progress, scratch.energy[threadIdx.x], [&](View<const int64_t> total) {
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

/// The step of a seed past its cell's centre (see relax_sheet::point_past_centre), by a group of lanes with the same
/// arguments: each divides for one component.
__device__ inline Vec64 step_together(const relax_sheet::CellSum& cell) {
  const int component = threadIdx.x & 3, group = threadIdx.x & 31 & ~(kWalkLanes - 1);
  const int64_t first = component == 0 ? cell.first_x : component == 1 ? cell.first_y : cell.first_z;
  const int64_t three = 3 * cell.mass;
  const int64_t way = cell.mass > 0 ? short_floor_div(2 * first + three, 2 * three) : 0;
  const int64_t step = relax_sheet::past_centre(way);
  return {__shfl_sync(~0u, step, group), __shfl_sync(~0u, step, group + 1), __shfl_sync(~0u, step, group + 2)};
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

/// Everything a seed does between two sums, by a group of lanes a seed: the step past the centre, and on ahead.
template <int kBlocks>
__global__ void __launch_bounds__(kMoveThreads, at_once(kBlocks)) move_seeds(const __grid_constant__ SheetMove move) {
  wait_for_earlier_kernels();
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
  Vec64 step = step_together(cell);
  const bool is_free = exists && seeds.is_free(i);
  bool active = is_free && cell.mass > 0, moved = active;
  const int legs = goes_on && beta_q15 != 0 ? 2 : 1;
#pragma unroll 1
  for (int leg = 0; leg < legs; ++leg) {
    if (leg == 1) {
      step = difference(centre, last) * beta_q15;
      step = {step.x >> 15, step.y >> 15, step.z >> 15};
      active = moved = is_free;
    }
    const Landing landing = walk_together(seeds.walk, at.vertex, moved_by(seeds, at.vertex, at.point, step), active);
    if (active) at = landing;
    if (leg == 0) centre = at.point;
  }
  __syncwarp();
  if (!exists || thread % kWalkLanes != 0) return;
  const Normal8 normal = moved ? seeds.walk.normal[at.vertex] : seeds.normal[i];
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
