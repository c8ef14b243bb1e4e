// Cooperative kernels of flood_shell's steps over leaves: a warp a leaf.
#pragma once

#include "cuda/sparse/leaf_cooperative.cuh"
#include "stages/shell/flood_body.h"

namespace isoshell {
namespace flood_cooperative {

struct NoShared {};

/// What a leaf needs for a round.
struct Scratch {
  flood::Spread::Halo halo;
  const LeafMask* around[27];
  uint64_t grown[10];
  LeafMask fresh;
  uint16_t offset[512];
};

}  // namespace flood_cooperative

template <>
struct CooperativeKernel<flood::FindNeighbours>
    : leaf_cooperative::CooperativeLeaf<flood::FindNeighbours, flood_cooperative::NoShared> {
  static __device__ void run(const flood::FindNeighbours& step, int64_t leaf, Shared&, int n) {
    if (n >= 27) return;
    const Voxel at = leaf_of_key(step.voxels.leaf_key[leaf]);
    step.out[leaf].leaf[n] = find_leaf(step.voxels, {at.x + n / 9 - 1, at.y + n / 3 % 3 - 1, at.z + n % 3 - 1});
  }
};

template <>
struct CooperativeKernel<flood::ListReached>
    : leaf_cooperative::CooperativeLeaf<flood::ListReached, flood_cooperative::NoShared> {
  static __device__ void run(const flood::ListReached& step, int64_t i, Shared&, int n) {
    const uint32_t leaf = step.leaves[i];
    const flood::Front& front = step.state.front[step.round & 1];
    if (n >= 27 || front.round[leaf] != step.round) return;
    const uint32_t other = step.state.neighbours[leaf].leaf[n];
    if (other == kNone || !reaches(front.mask[leaf], n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1)) return;
    if (atomic_max(step.state.due[other], step.round + 1)) step.reached[atomic_fetch_add(step.count[0], 1u)] = other;
  }
};

template <>
struct CooperativeKernel<flood::Spread> : leaf_cooperative::CooperativeLeaf<flood::Spread, flood_cooperative::Scratch> {
  static __device__ void run(const flood::Spread& step, int64_t i, Shared& scratch, int lane) {
    const flood::State& state = step.state;
    const uint32_t leaf = step.leaves[i];
    const flood::Front& before = state.front[~step.round & 1];
    if (lane < 27) {
      const uint32_t other = state.neighbours[leaf].leaf[lane];
      scratch.around[lane] = other != kNone && before.round[other] == step.round - 1 ? &before.mask[other] : nullptr;
    }
    __syncwarp();
    if (lane < 10) scratch.grown[lane] = grown_slice(scratch.around, lane - 1);
    __syncwarp();
    uint64_t fresh = 0;
    if (lane < 8) {
      uint64_t& done = state.done[leaf].word[lane];
      fresh = (scratch.grown[lane] | scratch.grown[lane + 1] | scratch.grown[lane + 2]) &
              state.voxels.mask[leaf].word[lane] & ~done;
      scratch.fresh.word[lane] = fresh;
      done |= fresh;
    }
    if (!__any_sync(kWholeWarp, fresh != 0)) return;
    const flood::Front& now = state.front[step.round & 1];
    if (lane < 8) now.mask[leaf].word[lane] = fresh;
    if (lane == 0) now.round[leaf] = step.round;
    read_halo(step, leaf, scratch, lane);
    const int count = leaf_cooperative::list_active(scratch.fresh, scratch.offset, lane);
    const Voxel at = leaf_of_key(state.voxels.leaf_key[leaf]);
    for (int k = lane; k < count; k += 32) {
      const int offset = scratch.offset[k];
      const int middle = flood::Spread::Halo::at(offset >> 6, offset >> 3 & 7, offset & 7);
      state.label[state.voxels.first[leaf] + rank_in_leaf(state.voxels.mask[leaf], offset)] =
          step.best_around(scratch.halo, middle, voxel_centre(voxel_at(at, offset)));
    }
  }

 private:
  static __device__ void read_halo(const flood::Spread& step, uint32_t leaf, Shared& scratch, int lane) {
    for (int h = lane; h < 1000; h += 32) scratch.halo.label[h] = kNone;
    __syncwarp();
    for (int n = 0; n < 27; ++n) {
      if (!scratch.around[n]) continue;
      const uint32_t other = step.state.neighbours[leaf].leaf[n];
      const int dx = n / 9 - 1, dy = n / 3 % 3 - 1, dz = n % 3 - 1;
      const uint64_t touching = flood::Spread::touching(dy, dz);
      for (int x = dx < 0 ? 7 : 0; x <= (dx > 0 ? 0 : 7); ++x) {
        const uint64_t bits = scratch.around[n]->word[x] & touching;
        if (!bits) continue;
        for (int bit = lane; bit < 64; bit += 32)
          if (bits >> bit & 1) step.read_voxel(other, x, bit, dx, dy, dz, scratch.halo);
      }
    }
    __syncwarp();
  }
};

}  // namespace isoshell
