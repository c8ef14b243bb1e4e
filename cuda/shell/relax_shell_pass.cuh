// One pass of relax_in_shell in two kernels: sum_parts (candidates, labels, sums of the cells; the last block ends the
// pass) and move_shell_seeds. Definition and arithmetic are those of stages/shell/relax_shell_body.h; labels are never
// stored.
#pragma once

#include "cuda/relax/pass_end.cuh"
#include "cuda/relax/patch_winners.cuh"
#include "stages/shell/relax_shell_body.h"

namespace isoshell::cuda_relax {

constexpr int kPartWarps = 4;

/// Sums over voxels of a leaf by their offsets from voxel 0. The largest: 512 * 147.
struct OffsetSums {
  uint32_t count_x, y_z;  ///< 16 bits each: 512 * 7 fits
  uint32_t squares;

  __device__ static OffsetSums of(int offset) {
    const uint32_t x = uint32_t(offset) >> 6, y = uint32_t(offset) >> 3 & 7, z = uint32_t(offset) & 7;
    return {1u | x << 16, y | z << 16, x * x + y * y + z * z};
  }
  __device__ void add(const OffsetSums& o) { count_x += o.count_x, y_z += o.y_z, squares += o.squares; }
};

/// What a pass reads of a part of a leaf beside its voxels' offsets. Parts are cubes, as large as seeds are apart: see
/// cube_edge_for.
struct alignas(16) ShellPart {
  int64_t voxel_first;
  Voxel leaf;        ///< leaf coordinates
  OffsetSums total;  ///< of all voxels
  uint16_t lo, hi;   ///< corners of the voxels' box, as offsets
  uint16_t voxels;
  uint16_t zero[5] = {};
};

struct ShellPass {
  const ShellPart* part;
  const uint16_t* offset;  ///< per active voxel, in its leaf; those of a part lie together
  int64_t parts;
  SeedSearch search;
  int32_t* reach;
  int32_t reach_slack;
  relax_shell::CellSums* cell;
  PassState* state;
  PassProgress* progress;
  int32_t tolerance_ppb;
};

/// Sums from voxel 0 to the seed, which is at `a` from that voxel's centre; returns their energy.
__device__ inline Int128 add_to_shell_cell(relax_shell::CellSums& cell, const OffsetSums& s, Vec64 a) {
  const int64_t n = s.count_x & 0xffff;
  const Vec64 first = {int64_t(s.count_x >> 16), int64_t(s.y_z & 0xffff), int64_t(s.y_z >> 16)};
  const Vec64 moment = first * kOneVoxelQ8 - a * n;
  atomic_add(cell.count, n);
  atomic_add(cell.x, moment.x);
  atomic_add(cell.y, moment.y);
  atomic_add(cell.z, moment.z);
  return int64_t(s.squares) * kOneVoxelQ8 * kOneVoxelQ8 - 2 * kOneVoxelQ8 * dot(a, first) + n * dot(a, a);
}

__device__ inline Local voxel_local(int offset) {
  return {(offset >> 6) * kOneVoxelQ8, (offset >> 3 & 7) * kOneVoxelQ8, (offset & 7) * kOneVoxelQ8};
}

/// From the centre of voxel 0.
__device__ inline PatchBox box_of(const ShellPart& part) {
  return {voxel_centre({part.leaf.x * 8, part.leaf.y * 8, part.leaf.z * 8}), voxel_local(part.lo), voxel_local(part.hi),
          0, 0};
}

/// Without penalties a limit is never tighter than the search finds it.
struct NoPenalty {
  __device__ int64_t operator()(const Winners&, int) const { return INT64_MAX; }
};

/// A part with more candidates than lists hold: each lane searches for its voxels.
__device__ __noinline__ inline Int128 sum_part_directly(const ShellPass& pass, int64_t number, int64_t limit) {
  Int128 energy = 0;
  const ShellPart& part = pass.part[number];
  const PatchBox box = box_of(part);
  const int32_t reach = reach_of(limit);
  for (int i = threadIdx.x & 31; i < part.voxels; i += 32) {
    const int offset = pass.offset[part.voxel_first + i];
    const Local u = voxel_local(offset);
    const PointQ8 p = {box.origin.x + u.x, box.origin.y + u.y, box.origin.z + u.z};
    const uint32_t id = label_directly(pass.search, box, reach, p, Normal8{0, 0, 0});
    energy += add_to_shell_cell(pass.cell[id], OffsetSums::of(offset),
                                difference(pass.search.seed[id].position(), box.origin));
  }
  return energy;
}

/// Sums per winner, in the lane of its number.
__device__ inline OffsetSums sum_voxels(const ShellPass& pass, const ShellPart& part, const SearchResult& found,
                                        const Winners& winners) {
  constexpr int kRounds = 4;
  const int lane = threadIdx.x & 31;
  OffsetSums mine{0, 0, 0};
  for (int base = 0; base < part.voxels; base += 32 * kRounds) {
    int label[kRounds];
    Local v[kRounds];
    OffsetSums sums[kRounds];
#pragma unroll
    for (int r = 0; r < kRounds; ++r) {
      const int i = base + 32 * r + lane;
      const int offset = i < part.voxels ? pass.offset[part.voxel_first + i] : 0;
      v[r] = voxel_local(offset);
      sums[r] = i < part.voxels ? OffsetSums::of(offset) : OffsetSums{0, 0, 0};
    }
    if (found.narrow) {
      winners_at(winners, found.count, v, label);
    } else {
#pragma unroll
      for (int r = 0; r < kRounds; ++r) label[r] = winner_at(winners, found.count, v[r], Normal8{0, 0, 0}, 0);
    }
    for (int c = 0; c < found.count; ++c) {
      OffsetSums of_winner{0, 0, 0};
#pragma unroll
      for (int r = 0; r < kRounds; ++r)
        if (label[r] == c) of_winner.add(sums[r]);
      of_winner = {warp_sum(of_winner.count_x), warp_sum(of_winner.y_z), warp_sum(of_winner.squares)};
      if (lane == c) mine.add(of_winner);
    }
  }
  return mine;
}

struct ShellScratch {
  Winners winners;
  SearchScratch search;
};

/// One warp's part; returns the lane's share of the energy.
__device__ inline Int128 sum_shell_part(const ShellPass& pass, int64_t number, ShellScratch& scratch) {
  const ShellPart& part = pass.part[number];
  if (part.voxels == 0) return 0;
  const int lane = threadIdx.x & 31;
  const PatchBox box = box_of(part);
  const int32_t reach = pass.reach[number];
  SearchResult found;
  if (!PatchSearch(pass.search, box, scratch.search).find_near(reach, scratch.winners, found) ||
      found.limit > int64_t(reach) * reach)
    found = find_winners(pass.search, box, reach, scratch.search, scratch.winners, NoPenalty{});
  if (lane == 0) pass.reach[number] = reach_of(found.limit) + pass.reach_slack;
  if (found.count > kMaxWinners) return sum_part_directly(pass, number, found.limit);
  OffsetSums sums = part.total;
  if (found.count > 1) sums = sum_voxels(pass, part, found, scratch.winners);
  if (lane >= found.count || sums.count_x == 0) return 0;
  const Local a = scratch.winners.place[lane];
  return add_to_shell_cell(pass.cell[scratch.winners.id[lane]], sums, {a.x, a.y, a.z});
}

__global__ void __launch_bounds__(kPartWarps * 32) sum_parts(const __grid_constant__ ShellPass pass) {
  __shared__ ShellScratch scratch[kPartWarps];
  if (pass_is_over(pass.state, pass.progress)) return;
  const int64_t part = int64_t(blockIdx.x) * kPartWarps + (threadIdx.x >> 5);
  Int128 energy = 0;
  if (part < pass.parts) energy = sum_shell_part(pass, part, scratch[threadIdx.x >> 5]);
  end_block<kPartWarps>(pass.progress, energy, [&](View<const int64_t> total) {
    relax_shell::FinishPass{{pass.state, 1}, total, pass.tolerance_ppb}(0);
  });
}

struct ShellMove {
  relax_shell::MoveSeed move;
  relax_shell::CellSums* cell;
  SeedRecord* record;
  BucketGrid grid;
  BucketTable from, to;
  const PassProgress* progress;
};

__global__ void __launch_bounds__(128) move_shell_seeds(const __grid_constant__ ShellMove m) {
  if (!m.progress->moving) return;
  const int64_t i = int64_t(blockIdx.x) * blockDim.x + threadIdx.x;
  if (i >= m.move.position.size) return;
  m.from.remove(m.grid, m.move.position[i], i);
  m.move.move(i);
  m.cell[i] = {0, 0, 0, 0};
  m.to.insert(m.grid, m.move.position[i], uint32_t(i));
  m.record[i] = seed_record(m.move.position[i], {0, 0, 0});
}

__global__ void start_shell_seeds(ShellMove m, PassState* state, PassProgress* progress) {
  const int64_t i = int64_t(blockIdx.x) * blockDim.x + threadIdx.x;
  if (i == 0) {
    relax_shell::StartPasses{{state, 1}}(0);
    *progress = PassProgress{};
  }
  if (i >= m.move.position.size) return;
  m.cell[i] = {0, 0, 0, 0};
  m.to.insert(m.grid, m.move.position[i], uint32_t(i));
  m.record[i] = seed_record(m.move.position[i], {0, 0, 0});
}

/// The part at (x, y, z) of a leaf, by a warp: lists its voxels from `first` on.
__device__ inline ShellPart describe_part(const LeafMask& mask, Voxel leaf, int edge, Voxel at, int64_t first,
                                          uint16_t* offsets) {
  const int lane = threadIdx.x & 31;
  OffsetSums total{0, 0, 0};
  int count = 0;
  unsigned x = 0, y = 0, z = 0;
  for (int base = 0; base < edge * edge * edge; base += 32) {
    const int i = base + lane;
    const int offset = (at.x + i / (edge * edge)) << 6 | (at.y + i / edge % edge) << 3 | (at.z + i % edge);
    const bool in = i < edge * edge * edge && (mask.word[offset >> 6 & 7] >> (offset & 63) & 1);
    const unsigned on = __ballot_sync(kWholeWarp, in);
    if (in) {
      offsets[first + count + lanes_before(on)] = uint16_t(offset);
      total.add(OffsetSums::of(offset));
      x |= 1u << (offset >> 6), y |= 1u << (offset >> 3 & 7), z |= 1u << (offset & 7);
    }
    count += __popc(on);
  }
  total = {warp_sum(total.count_x), warp_sum(total.y_z), warp_sum(total.squares)};
  x = warp_or(x), y = warp_or(y), z = warp_or(z);
  const auto lowest = [](unsigned w) { return w ? __ffs(int(w)) - 1 : 0; };
  const auto highest = [](unsigned w) { return w ? 31 - __clz(int(w)) : 0; };
  return {first,
          leaf,
          total,
          uint16_t(lowest(x) << 6 | lowest(y) << 3 | lowest(z)),
          uint16_t(highest(x) << 6 | highest(y) << 3 | highest(z)),
          uint16_t(count)};
}

/// One warp a leaf.
__global__ void describe_parts(VoxelSetView voxels, int edge, ShellPart* out, uint16_t* offsets, int64_t spacing_q8,
                               int32_t* reach) {
  const int64_t number = (int64_t(blockIdx.x) * blockDim.x + threadIdx.x) >> 5;
  if (number >= voxels.leaf_key.size) return;
  const Voxel leaf = leaf_of_key(voxels.leaf_key[number]);
  const int along = 8 / edge, parts = along * along * along;
  int64_t first = voxels.first[number];
  for (int p = 0; p < parts; ++p) {
    const Voxel at = {p / (along * along) * edge, p / along % along * edge, p % along * edge};
    const ShellPart part = describe_part(voxels.mask[number], leaf, edge, at, first, offsets);
    first += part.voxels;
    if (threadIdx.x & 31) continue;
    out[number * parts + p] = part;
    const Local lo = voxel_local(part.lo), hi = voxel_local(part.hi);
    reach[number * parts + p] = reach_of(square({hi.x - lo.x, hi.y - lo.y, hi.z - lo.z})) + int32_t(spacing_q8 * 3 / 4);
  }
}

}  // namespace isoshell::cuda_relax
