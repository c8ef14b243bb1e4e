// One pass of relax_in_shell in two kernels: sum_parts (candidates, labels, sums of the cells; the last block ends the
// pass) and move_shell_seeds. Definition and arithmetic are those of stages/shell/relax_shell_body.h; labels are never
// stored.
#pragma once

#include "cuda/relax/pass_end.cuh"
#include "cuda/relax/patch_pieces.cuh"
#include "cuda/relax/patch_winners.cuh"
#include "stages/shell/relax_shell_body.h"

namespace isoshell::cuda_relax {

constexpr int kPartWarps = 4;
constexpr int kPartBlocks = 8;  ///< a multiprocessor

/// Sums over voxels of a leaf by their offsets from voxel 0, 16 bits each: 512 * 7 fits.
struct OffsetSums {
  uint32_t count_x, y_z;

  __device__ static OffsetSums of(int offset) {
    const uint32_t x = uint32_t(offset) >> 6, y = uint32_t(offset) >> 3 & 7, z = uint32_t(offset) & 7;
    return {1u | x << 16, y | z << 16};
  }
  __device__ void add(const OffsetSums& o) { count_x += o.count_x, y_z += o.y_z; }
  __device__ int64_t count() const { return count_x & 0xffff; }
  __device__ Vec64 first() const { return {int64_t(count_x >> 16), int64_t(y_z & 0xffff), int64_t(y_z >> 16)}; }
};
__device__ inline uint32_t square_of(int offset) {
  const uint32_t x = uint32_t(offset) >> 6, y = uint32_t(offset) >> 3 & 7, z = uint32_t(offset) & 7;
  return x * x + y * y + z * z;
}

/// Leaves are summed whole, or by their octants where seeds are so dense that more than kMaxWinners could label a leaf.
inline int parts_of_leaf(int64_t seed_spacing_q8) { return seed_spacing_q8 >= 15 * kOneVoxelQ8 / 4 ? 1 : 8; }

__device__ inline LeafCube part_of_leaf(const LeafMask& mask, int parts, int number) {
  const LeafCube whole = cube_of_leaf(mask, 8, 0, 0, 0);
  return parts == 1 ? whole : octant_of(mask, whole, number);
}

/// What a pass reads of a part of a leaf beside its voxels' offsets.
struct alignas(16) ShellPart {
  int64_t voxel_first;
  Voxel leaf;        ///< leaf coordinates
  OffsetSums total;  ///< of all voxels
  uint32_t squares;  ///< sum over all voxels of the squared offset
  uint16_t lo, hi;   ///< corners of the voxels' box, as offsets
  uint16_t voxels;
  uint16_t zero[5] = {};
};

struct ShellPass {
  const ShellPart* part;
  const uint16_t* offset;  ///< per active voxel, in its leaf; those of a part lie together
  int64_t parts;
  SeedSearch search;
  int32_t* reach;  ///< per part: how far seeds may be that label it
  int32_t reach_slack;
  relax_shell::CellSums* cell;
  PassState* state;
  PassProgress* progress;
  int32_t tolerance_ppb;
};

/// Adds the sums from voxel 0 to a seed that is at `a` from that voxel's centre.
__device__ inline void add_to_shell_cell(relax_shell::CellSums& cell, const OffsetSums& s, Vec64 a) {
  const Vec64 moment = s.first() * kOneVoxelQ8 - a * s.count();
  in_patch::add_unread(cell.count, s.count());
  in_patch::add_unread(cell.x, moment.x);
  in_patch::add_unread(cell.y, moment.y);
  in_patch::add_unread(cell.z, moment.z);
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

struct ShellScratch {
  Winners winners;
  SearchScratch search;
  Int128 energy[32];  ///< per lane
};

/// What labelling the voxels of a part gives a lane.
struct PartLabels {
  OffsetSums sums;  ///< of the winner of the lane's number
  int64_t energy;   ///< of the voxels that the lane labelled
  int64_t most;     ///< squared distance of the part's voxel that is farthest from its seed
};

__device__ inline PartLabels label_voxels(const ShellPass& pass, const ShellPart& part, const SearchResult& found,
                                          const Winners& winners) {
  constexpr int kAtOnce = 2;
  const int lane = threadIdx.x & 31;
  PartLabels out{{0, 0}, 0, 0};
  for (int base = lane; base - lane < part.voxels; base += 32 * kAtOnce) {
    int label[kAtOnce];
    int32_t least[kAtOnce] = {};
    Local v[kAtOnce];
    OffsetSums sums[kAtOnce];
#pragma unroll
    for (int r = 0; r < kAtOnce; ++r) {
      const bool in = base + 32 * r < part.voxels;
      const int offset = in ? pass.offset[part.voxel_first + base + 32 * r] : 0;
      v[r] = voxel_local(offset);
      sums[r] = in ? OffsetSums::of(offset) : OffsetSums{0, 0};
    }
    if (found.narrow) winners_at(winners, found.count, v, label, least);
    uint32_t used = 0;
#pragma unroll
    for (int r = 0; r < kAtOnce; ++r) {
      int64_t cost = uint32_t(least[r]) + square_32(v[r]);
      if (!found.narrow) {
        const NearestWinner nearest = nearest_winner(winners, found.count, v[r], Normal8{0, 0, 0}, 0);
        label[r] = nearest.number;
        cost = nearest.cost;
      }
      if (base + 32 * r >= part.voxels) continue;
      used |= 1u << label[r];
      out.energy += cost;
      out.most = max(out.most, cost);
    }
    for (uint32_t left = warp_or(used); left != 0; left &= left - 1) {
      const int winner = __ffs(int(left)) - 1;
      OffsetSums of_winner{0, 0};
#pragma unroll
      for (int r = 0; r < kAtOnce; ++r)
        if (label[r] == winner) of_winner.add(sums[r]);
      of_winner = {warp_sum(of_winner.count_x), warp_sum(of_winner.y_z)};
      if (lane == winner) out.sums.add(of_winner);
    }
  }
  out.most = warp_max(out.most);
  return out;
}

/// Adds the sums of a part to the cells of the winners that were found, and to the lanes' energies. False when a seed
/// beyond what was looked at may be nearer to a voxel. `reach` becomes how far seeds may be that label the part.
__device__ inline bool sum_winners(const ShellPass& pass, const ShellPart& part, const SearchResult& found,
                                   ShellScratch& scratch, int32_t& reach) {
  const Winners& winners = scratch.winners;
  const int lane = threadIdx.x & 31;
  const int64_t reach_sq = int64_t(found.reach) * found.reach;
  if (found.count == 1 && found.limit <= reach_sq) {
    if (lane == 0) {
      const Vec64 a = {winners.place[0].x, winners.place[0].y, winners.place[0].z};
      add_to_shell_cell(pass.cell[winners.id[0]], part.total, a);
      scratch.energy[0] += int64_t(part.squares) * kOneVoxelQ8 * kOneVoxelQ8 -
                           2 * kOneVoxelQ8 * dot(a, part.total.first()) + part.total.count() * dot(a, a);
    }
    reach = reach_of(found.limit);
    return true;
  }
  const PartLabels labelled = label_voxels(pass, part, found, winners);
  reach = reach_of(labelled.most);
  if (labelled.most > reach_sq) return false;
  if (labelled.sums.count() != 0) {
    const WinnerPlace a = winners.place[lane];
    add_to_shell_cell(pass.cell[winners.id[lane]], labelled.sums, {a.x, a.y, a.z});
  }
  scratch.energy[lane] += labelled.energy;
  return true;
}

/// A part with more winners than lists hold: each lane looks for the seeds of its voxels, first within `reach`. Returns
/// the squared distance of the voxel that is farthest from its seed.
__device__ inline int64_t sum_directly(const ShellPass& pass, const ShellPart& part, int32_t reach, int64_t limit,
                                       ShellScratch& scratch) {
  const PointQ8 origin = box_of(part).origin;
  int64_t most = 0;
  for (int i = threadIdx.x & 31; i < part.voxels; i += 32) {
    const int offset = pass.offset[part.voxel_first + i];
    const Local u = voxel_local(offset);
    const PointQ8 p = {origin.x + u.x, origin.y + u.y, origin.z + u.z};
    const PatchBox at = {p, {0, 0, 0}, {0, 0, 0}, 0, 0};
    uint32_t id = label_directly(pass.search, at, reach, p, Normal8{0, 0, 0});
    if (id == kNone || distance_sq_q16(p, pass.search.seed[id].position()) > int64_t(reach) * reach)
      id = label_directly(pass.search, at, reach_of(limit), p, Normal8{0, 0, 0});
    const PointQ8 seed = pass.search.seed[id].position();
    add_to_shell_cell(pass.cell[id], OffsetSums::of(offset), difference(seed, origin));
    const int64_t distance_sq = distance_sq_q16(p, seed);
    scratch.energy[threadIdx.x & 31] += distance_sq;
    most = max(most, distance_sq);
  }
  return warp_max(most);
}

/// Any part, whatever the seeds around it; see sum_part.
__device__ __noinline__ inline int32_t sum_slowly(const ShellPass& pass, const ShellPart& part, int32_t reach,
                                                  ShellScratch& scratch) {
  const SearchResult found =
      find_winners(pass.search, box_of(part), reach, scratch.search, scratch.winners, NoPenalty{});
  if (found.count > kMaxWinners) return reach_of(sum_directly(pass, part, reach, found.limit, scratch));
  sum_winners(pass, part, found, scratch, reach);
  return reach;
}

/// One part, by one warp. Looks for seeds within `reach` first; returns how far seeds may be that label it.
__device__ inline int32_t sum_part(const ShellPass& pass, const ShellPart& part, int32_t reach, ShellScratch& scratch) {
  SearchResult found;
  while (PatchSearch(pass.search, box_of(part), scratch.search).find_near(reach, scratch.winners, found))
    if (sum_winners(pass, part, found, scratch, reach)) return reach;
  return sum_slowly(pass, part, reach, scratch);
}

__global__ void __launch_bounds__(kPartWarps * 32, kPartBlocks) sum_parts(const __grid_constant__ ShellPass pass) {
  __shared__ ShellScratch of_warp[kPartWarps];
  if (pass_is_over(pass.state, pass.progress)) return;
  const int warp = int(threadIdx.x) >> 5, lane = int(threadIdx.x) & 31;
  ShellScratch& scratch = of_warp[warp];
  scratch.energy[lane] = 0;
  for (int64_t i = int64_t(blockIdx.x) * kPartWarps + warp; i < pass.parts; i += int64_t(gridDim.x) * kPartWarps) {
    const int32_t reach = sum_part(pass, pass.part[i], pass.reach[i], scratch);
    if (lane == 0) pass.reach[i] = reach + pass.reach_slack;
    __syncwarp();  // all have read the scratch
  }
  end_block<kPartWarps>(pass.progress, scratch.energy[lane], [&](View<const int64_t> total) {
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

/// How many parts of a leaf hold voxels.
struct CountLeafParts {
  VoxelSetView voxels;
  int of_leaf;
  View<int64_t> count;
  __device__ void operator()(int64_t leaf) const {
    int64_t parts = 0;
    for (int i = 0; i < of_leaf; ++i) parts += !part_of_leaf(voxels.mask[leaf], of_leaf, i).empty();
    count[leaf] = parts;
  }
};

/// One warp a leaf.
__global__ void describe_parts(VoxelSetView voxels, int of_leaf, View<const int64_t> first_part, ShellPart* out,
                               uint16_t* offsets) {
  const int64_t number = (int64_t(blockIdx.x) * blockDim.x + threadIdx.x) >> 5;
  const int lane = threadIdx.x & 31;
  if (number >= voxels.leaf_key.size) return;
  int64_t voxel = voxels.first[number], part = first_part[number];
  for (int i = 0; i < of_leaf; ++i) {
    const LeafCube cube = part_of_leaf(voxels.mask[number], of_leaf, i);
    OffsetSums total{0, 0};
    uint32_t squares = 0;
    int at = 0;
    unsigned x = 0, y = 0, z = 0;
    for (int base = 0; base < cube.edge * 64; base += 32) {
      const int slice = (base + lane) >> 6, offset = (cube.x << 6) + base + lane;
      const unsigned on = __ballot_sync(~0u, cube.row[slice] >> (offset & 63) & 1);
      if (on >> lane & 1) {
        offsets[voxel + at + lanes_before(on)] = uint16_t(offset);
        total.add(OffsetSums::of(offset));
        squares += square_of(offset);
        x |= 1u << (offset >> 6), y |= 1u << (offset >> 3 & 7), z |= 1u << (offset & 7);
      }
      at += __popc(on);
    }
    if (at == 0) continue;
    total = {warp_sum(total.count_x), warp_sum(total.y_z)};
    squares = warp_sum(squares);
    x = warp_or(x), y = warp_or(y), z = warp_or(z);
    if (lane == 0) {
      const auto corner = [](int cx, int cy, int cz) { return uint16_t(cx << 6 | cy << 3 | cz); };
      const auto highest = [](unsigned w) { return 31 - __clz(int(w)); };
      out[part] = {voxel,
                   leaf_of_key(voxels.leaf_key[number]),
                   total,
                   squares,
                   corner(lowest_bit(x), lowest_bit(y), lowest_bit(z)),
                   corner(highest(x), highest(y), highest(z)),
                   uint16_t(at)};
    }
    voxel += at;
    ++part;
  }
}

}  // namespace isoshell::cuda_relax
