// The patches that a warp works on, one after the other, taken from those that are left.
#pragma once

#include "cuda/relax/patch_labels.cuh"

namespace isoshell::cuda_relax {

/// Some patches take much longer than others, so each warp takes the next one when it is nearly done. What describes
/// that comes while the one before it is worked on. Blocks are one warp.
class PatchQueue {
 public:
  /// Shared memory.
  struct Room {
    Patch patch[2];
    PatchWinners winners[2];
  };

  /// `taken` counts the patches beyond each warp's first, over all warps.
  __device__ PatchQueue(const SheetPass& pass, uint32_t& taken, Room& room)
      : pass_(pass), taken_(taken), room_(room), number_(blockIdx.x) {
    copy_description();
    wait_for_copies();
  }

  __device__ bool has_patch() const { return number_ < pass_.patches.count; }
  __device__ int64_t number() const { return number_; }
  __device__ const Patch& patch() const { return room_.patch[turn_]; }
  __device__ const PatchWinners& winners() const { return room_.winners[turn_]; }

  /// Takes the next patch, for `start`. The answer is slow: best asked for before something else is waited for.
  __device__ uint32_t take() { return (threadIdx.x & 31) == 0 ? atomicAdd(&taken_, 1u) : 0; }
  /// Starts to copy what describes the patch taken; `patch` and `winners` are still those of the last one.
  __device__ void start(uint32_t taken) {
    number_ = gridDim.x + __shfl_sync(kWholeWarp, taken, 0);
    turn_ ^= 1;
    copy_description();
    turn_ ^= 1;
  }
  /// Goes on to it.
  __device__ void go_on() {
    turn_ ^= 1;
    wait_for_copies();
  }

 private:
  __device__ void copy_description() {
    if (!has_patch()) return;
    start_copy(&room_.patch[turn_], pass_.patches.patch + number_, 1);
    start_copy(&room_.winners[turn_], pass_.winners + number_, 1);
  }

  const SheetPass& pass_;
  uint32_t& taken_;
  Room& room_;
  uint32_t number_;
  int turn_ = 0;
};

}  // namespace isoshell::cuda_relax
