// PlainFindOutside (see stages/sheet/sheet_flood_body.h) on the device: a block of threads a block of leaves, eight
// lanes a leaf, and several rounds between two looks of the host. The fixed point does not depend on who spreads it.
#pragma once

#include <algorithm>

#include "cuda/runtime/cooperative_kernel.cuh"
#include "cuda/runtime/executor_cuda.cuh"
#include "stages/sheet/sheet_flood_body.h"

namespace isoshell {
namespace flood_kernels {

constexpr int kRoundsPerLook = 8;  ///< even: worklists trade places every round
constexpr int kThreads = 256;
constexpr int kBlockThreads = 1024;  ///< that share a block of leaves
constexpr int kBlocks = 4;           ///< a multiprocessor; each takes several nodes if need be

/// The tail of a worklist that is filled from its end.
struct Worklist {
  View<const uint32_t> node;
  const uint32_t* left;
  __device__ int64_t size() const { return node.size - int64_t(*left); }
  __device__ uint32_t operator[](int64_t i) const { return node[int64_t(*left) + i]; }
};

/// The part of FloodState::enter_block_side that belongs to one of the side's 256 leaves.
__device__ inline void enter_side_leaf(const sheet_steps::FloodState& state, Voxel first_leaf, int face, int number) {
  const int64_t t = state.out.table_index(first_leaf);
  if (t < 0) return;
  if (state.out.blocked.block_table[t] == kNone) {
    if (number == 0) state.enter_empty_block(t);
    return;
  }
  const int32_t fixed = face & 1 ? 0 : 15, i = number >> 4, j = number & 15;
  const Voxel l = {first_leaf.x + (face < 2 ? fixed : i),
                   first_leaf.y + (face >> 1 == 1 ? fixed
                                   : face < 2     ? i
                                                  : j),
                   first_leaf.z + (face >> 1 == 2 ? fixed : j)};
  state.enter(l, crossing(uniform_leaf(true), face));
}
constexpr int kSideLeaves = 6 * 256;  ///< leaves on the sides of a block

__global__ void __launch_bounds__(kBlockThreads) enter_from_border(sheet_steps::FloodState state, int64_t entries) {
  for (int64_t t = blockIdx.x; t < entries; t += gridDim.x) {
    const Voxel first = state.first_leaf_of_entry(t);
    for (int task = int(threadIdx.x); task < kSideLeaves; task += kBlockThreads) {
      const int face = task >> 8;
      if (state.out.table_index(step_through(first, face, 16)) < 0) enter_side_leaf(state, first, face ^ 1, task & 255);
    }
  }
}

/// flood_block by a block of threads, a word each.
__device__ inline void flood_words(const uint64_t* free, uint64_t* reached) {
  constexpr uint64_t kLow = 0x0001000100010001ull;
  const int w = int(threadIdx.x);
  bool grew = true;
  while (__syncthreads_or(grew)) {
    grew = false;
    uint64_t r = 0;
    if (w < 64) {
      r = reached[w];
      if (w & 3) r |= reached[w - 1] >> 48;
      if ((w & 3) != 3) r |= reached[w + 1] << 48;
      if (w >= 4) r |= reached[w - 4];
      if (w < 60) r |= reached[w + 4];
      r &= free[w];
      for (uint64_t last = ~r; r != last;) {
        last = r;
        r |= free[w] & ((r << 1 & ~kLow) | (r >> 1 & ~(kLow << 15)) | r << 16 | r >> 16);
      }
    }
    __syncthreads();
    if (w < 64 && r != reached[w]) {
      reached[w] = r;
      grew = true;
    }
  }
}

__global__ void __launch_bounds__(kBlockThreads) flood_blocks(sheet_steps::FloodState state, Worklist list) {
  __shared__ uint64_t free[64], reached[64], fresh[64];
  const int64_t count = list.size();
  const int thread = int(threadIdx.x);
  for (int64_t i = blockIdx.x; i < count; i += gridDim.x) {
    const uint32_t t = list[i], b = state.out.blocked.block_table[t];
    const Voxel first = state.first_leaf_of_entry(t);
    if (b == kNone) {
      for (int task = thread; task < kSideLeaves; task += kBlockThreads)
        enter_side_leaf(state, step_through(first, task >> 8, 16), task >> 8, task & 255);
      continue;
    }
    __syncthreads();  // the last node's bits have been used
    if (thread < 64) {
      free[thread] = ~state.out.blocked.blocks[b].word[thread];
      reached[thread] = atomic_load(state.out.empty[b].word[thread]) & free[thread];
    }
    flood_words(free, reached);
    if (thread < 64) {
      const uint64_t all = reached[thread], bits = all & ~state.passed_on[b].word[thread];
      fresh[thread] = bits;
      if (bits) {
        state.passed_on[b].word[thread] = all;
        atomic_or(state.out.empty[b].word[thread], bits);
      }
    }
    __syncthreads();
    for (int bit = thread; bit < 4096; bit += kBlockThreads) {
      if (!(fresh[bit >> 6] >> (bit & 63) & 1)) continue;
      const Voxel l = {first.x + (bit >> 8), first.y + ((bit >> 4) & 15), first.z + (bit & 15)};
      for (int face = 0; face < 6; ++face) {
        const Voxel n = step_through(l, face);
        const bool same_block = n.x >> 4 == l.x >> 4 && n.y >> 4 == l.y >> 4 && n.z >> 4 == l.z >> 4;
        const int other = (n.x & 15) << 8 | (n.y & 15) << 4 | (n.z & 15);
        if (same_block && (free[other >> 6] >> (other & 63) & 1)) continue;  // reached already
        state.enter(n, crossing(uniform_leaf(true), face));
      }
    }
  }
}

/// Eight lanes a leaf, a word each.
__global__ void __launch_bounds__(kThreads) flood_leaves(sheet_steps::FloodState state, Worklist list) {
  const int64_t count = list.size();
  const int x = int(threadIdx.x) & 7;
  const unsigned lanes = group_lanes<8>();
  for (int64_t i = (int64_t(blockIdx.x) * kThreads + threadIdx.x) >> 3; i < count;
       i += int64_t(gridDim.x) * (kThreads / 8)) {
    const uint32_t number = list[i];
    const uint64_t free = ~state.out.blocked.mask[number].word[x];
    const uint64_t before = atomic_load(state.out.leaf[number].word[x]);
    uint64_t reached = before;
    for (bool grew = true; __any_sync(lanes, grew);) {
      const uint64_t up = __shfl_up_sync(lanes, reached, 1, 8), down = __shfl_down_sync(lanes, reached, 1, 8);
      const uint64_t all = flood_word(free, (reached | (x > 0 ? up : 0) | (x < 7 ? down : 0)) & free);
      grew = all != reached;
      reached = all;
    }
    if (reached != before) atomic_or(state.out.leaf[number].word[x], reached);
    LeafMask whole;
    for (int w = 0; w < 8; ++w) whole.word[w] = __shfl_sync(lanes, reached, w, 8);
    if (x < 6) {
      const LeafMask voxels = crossing(whole, x);
      uint64_t any = 0;
      for (uint64_t w : voxels.word) any |= w;
      if (any) state.enter(step_through(leaf_of_key(state.out.blocked.leaf_key[number]), x), voxels);
    }
    __syncwarp(lanes);
  }
}

/// A worklist whose lengths stay on the device for kRoundsPerLook rounds.
struct Queue {
  Buffer<uint32_t> stamp, node[2], left;
  int64_t capacity;

  Queue(CudaExecutor& exec, int64_t count)
      : stamp(exec.make<uint32_t>(count)),
        node{exec.make<uint32_t>(count), exec.make<uint32_t>(count)},
        left(exec.make<uint32_t>(kRoundsPerLook + 1)),
        capacity(count) {}
  sheet_steps::FloodList list_of(int round) {
    return {stamp.view(), node[round & 1].view(), left.view().part(round, 1)};
  }
  Worklist of(int round) const { return {node[round & 1].view(), left.data() + round}; }
};

/// What the flood starts from: nothing reached, nothing listed.
struct Start {
  sheet_steps::FloodState state;
  View<uint32_t> left[2];
  int64_t capacity[2];
};
__global__ void __launch_bounds__(kThreads) start_flood(Start start) {
  const int64_t first = int64_t(blockIdx.x) * kThreads + threadIdx.x, step = int64_t(gridDim.x) * kThreads;
  const auto set = [&](auto* data, int64_t count, auto value) {
    for (int64_t i = first; i < count; i += step) data[i] = value;
  };
  const sheet_steps::FloodState& s = start.state;
  set(&s.out.leaf.data->word[0], s.out.leaf.size * 8, uint64_t(0));
  set(&s.out.empty.data->word[0], s.out.empty.size * 64, uint64_t(0));
  set(&s.passed_on.data->word[0], s.passed_on.size * 64, uint64_t(0));
  set(s.out.block.data, s.out.block.size, 0u);
  set(s.leaves.stamp.data, s.leaves.stamp.size, 0u);
  set(s.blocks.stamp.data, s.blocks.stamp.size, 0u);
  for (int q = 0; q < 2; ++q) set(start.left[q].data, start.left[q].size, uint32_t(start.capacity[q]));
}

/// The last round's lists become the first of the next rounds. Tells the host how many nodes they hold.
__global__ void turn_queues(Start start, int64_t* listed) {
  int64_t count = 0;
  for (int q = 0; q < 2; ++q) {
    const uint32_t last = start.left[q][kRoundsPerLook];
    count += start.capacity[q] - int64_t(last);
    start.left[q][0] = last;
    for (int round = 1; round <= kRoundsPerLook; ++round) start.left[q][round] = uint32_t(start.capacity[q]);
  }
  *listed = count;
}

}  // namespace flood_kernels

struct FindOutsideByBlocks {
  static Outside run(CudaExecutor& exec, const VoxelSetView& blocked, View<const Voxel> hollows) {
    using namespace flood_kernels;
    Outside outside;
    outside.blocked = blocked;
    outside.leaf = exec.make<LeafMask>(blocked.leaf_key.size);
    outside.empty = exec.make<BlockMask>(blocked.blocks.size);
    outside.block = exec.make<uint32_t>(blocked.block_table.size);
    Buffer<BlockMask> passed_on = exec.make<BlockMask>(blocked.blocks.size);
    const int64_t entries = blocked.block_table.size;
    Queue leaves(exec, blocked.leaf_key.size), blocks(exec, entries);
    sheet_steps::FloodState state = {outside.view(), passed_on.view(), leaves.list_of(0), blocks.list_of(0), 1};
    const Start start = {state, {leaves.left.view(), blocks.left.view()}, {leaves.capacity, blocks.capacity}};
    const auto resident = [&](int64_t needed) { return exec.device().resident_blocks(needed, kBlocks); };
    const int64_t words = std::max(outside.leaf.size() * 8, passed_on.size() * 64);
    start_flood<<<resident(blocks_for(words, kThreads)), kThreads, 0, exec.stream()>>>(start);
    exec.check("start flood");
    enter_from_border<<<resident(entries), kBlockThreads, 0, exec.stream()>>>(state, entries);
    exec.check("enter from the border");
    exec.for_each("enter hollows", hollows.size, sheet_steps::EnterHollow{state, hollows});
    int64_t* const listed = static_cast<int64_t*>(exec.device().pinned());
    do {
      for (int round = 0; round < kRoundsPerLook; ++round) {
        state.leaves = leaves.list_of(round + 1);
        state.blocks = blocks.list_of(round + 1);
        ++state.next_round;
        flood_blocks<<<resident(entries), kBlockThreads, 0, exec.stream()>>>(state, blocks.of(round));
        exec.check("flood blocks");
        flood_leaves<<<resident(blocks_for(leaves.capacity, 32)), kThreads, 0, exec.stream()>>>(state,
                                                                                                leaves.of(round));
        exec.check("flood leaves");
      }
      turn_queues<<<1, 1, 0, exec.stream()>>>(start, listed);
      exec.check("turn queues");
      exec.device().synchronize();
    } while (*listed > 0);
    return outside;
  }
};

}  // namespace isoshell
