// How a relaxation pass ends on the device: blocks add their energy, and the last one to finish runs FinishPass.
#pragma once

#include "cuda/runtime/warp.cuh"
#include "stages/relax/pass_state.h"
#include "voxel/atomic.h"

namespace isoshell::cuda_relax {

constexpr int kEnergySlots = 32;  ///< so that not all blocks add to one word; one lane a slot at the end

/// Beside PassState: what the kernels of a pass tell each other. Zero at first.
struct PassProgress {
  SplitSum energy[kEnergySlots];
  uint32_t blocks_done[kEnergySlots];  ///< of those that share a slot
  uint32_t slots_done;
  uint32_t patches_labelled, patches_summed;  ///< that were taken beyond each block's first
  uint32_t moving;                            ///< this pass took place: its seeds move
};

/// True when there is no pass to run any more. All threads of the grid ask.
__device__ inline bool pass_is_over(const PassState* state, PassProgress* progress) {
  if (!state->converged) return false;
  if (blockIdx.x == 0 && threadIdx.x == 0) progress->moving = 0;
  return true;
}

/// Sum over the warp's lanes. Ordinary energies need no more than one word.
__device__ inline SplitSum sum_energy(Int128 energy) {
  const int64_t word = int64_t(energy);
  if (__all_sync(~0u, energy == word && word < int64_t(1) << 57 && word > -(int64_t(1) << 57)))
    return SplitSum::of(warp_sum(word));
  const SplitSum part = SplitSum::of(energy);
  return {warp_sum(part.high), warp_sum(part.low)};
}

/// All threads of all blocks call it with their part of the energy; `finish` runs once, in one thread, with the upper
/// and lower part of the sum.
template <int kWarps, class Finish>
__device__ inline void end_block(PassProgress* progress, Int128 energy, Finish finish) {
  __shared__ SplitSum of_warp[kWarps];
  __shared__ bool last;
  const SplitSum sum = sum_energy(energy);
  if ((threadIdx.x & 31) == 0) of_warp[threadIdx.x >> 5] = sum;
  __syncthreads();
  if (threadIdx.x == 0) {
    SplitSum all{0, 0};
    for (const SplitSum& s : of_warp) all.high += s.high, all.low += s.low;
    const unsigned number = blockIdx.x % kEnergySlots;
    SplitSum& slot = progress->energy[number];
    atomic_add(slot.high, all.high);
    atomic_add(slot.low, all.low);
    __threadfence();
    const unsigned sharing = (gridDim.x - number + kEnergySlots - 1) / kEnergySlots;
    last = atomicAdd(&progress->blocks_done[number], 1u) == sharing - 1;
    __threadfence();
    if (last) last = atomicAdd(&progress->slots_done, 1u) == min(gridDim.x, unsigned(kEnergySlots)) - 1;
  }
  __syncthreads();
  if (!last || threadIdx.x >= 32) return;
  __threadfence();
  static_assert(kEnergySlots == 32, "one lane a slot");
  SplitSum& slot = progress->energy[threadIdx.x];
  const int64_t total[2] = {warp_sum(__ldcg(reinterpret_cast<const long long*>(&slot.high))),
                            warp_sum(__ldcg(reinterpret_cast<const long long*>(&slot.low)))};
  slot = {0, 0};
  progress->blocks_done[threadIdx.x] = 0;
  if (threadIdx.x != 0) return;
  finish(View<const int64_t>{total, 2});
  progress->slots_done = 0;
  progress->patches_labelled = progress->patches_summed = 0;
  progress->moving = 1;
}

}  // namespace isoshell::cuda_relax
