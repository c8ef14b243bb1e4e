// dual::PlainSplitCells (see stages/dual/dual_split_body.h) on the device: a block of threads a cell. Levels of the
// breadth-first searches are swept in step; within a level every vertex looks at its neighbours, so nothing depends on
// an order.
#pragma once

#include "cuda/runtime/cooperative_kernel.cuh"
#include "cuda/runtime/executor_cuda.cuh"
#include "stages/dual/dual_split_body.h"

namespace isoshell::dual {
namespace split_kernels {

constexpr int kThreads = 512;
constexpr int kSlots = 8;  ///< neighbours in the cell that are kept at hand; vertices with more walk the sheet
constexpr uint32_t kFar = kNone;
constexpr uint32_t kMany = kNone - 1;  ///< in slot 0: more than kSlots neighbours

/// Scratch of all splits of a round, by the cells' places in the queue.
struct Scratch {
  View<uint32_t> place_of;                 ///< per sheet vertex of a cell that is split: its place in the cell
  View<uint32_t> split_of;                 ///< per cell that is split: number of its split
  View<uint32_t> cursor;                   ///< per split
  View<uint32_t> neighbour;                ///< kSlots a place: places of neighbours in the cell, then kNone
  View<uint32_t> from_first, from_second;  ///< edges from the two sources

  __device__ bool is_in_second(int64_t at) const { return from_second[at] < from_first[at]; }
};

struct NumberSplits {
  View<const uint32_t> cell;
  View<uint32_t> split_of, cursor;
  ISOSHELL_HD void operator()(int64_t i) const {
    split_of[cell[i]] = uint32_t(i);
    cursor[i] = 0;
  }
};

/// Lists the vertices of every cell that is split: all of its label, since every cell is in one piece.
struct ListMembers {
  SplitCell split;
  Scratch scratch;
  ISOSHELL_HD void operator()(int64_t v) const {
    const uint32_t id = split.label[v];
    if (split.request[id] == kNoSplit) return;
    const uint32_t i = scratch.split_of[id];
    const uint32_t place = atomic_fetch_add(scratch.cursor[i], 1u);
    split.queue[split.first[i] + place] = uint32_t(v);
    scratch.place_of[v] = place;
  }
};

struct ListNeighbours {
  SplitCell split;
  Scratch scratch;
  ISOSHELL_HD void operator()(int64_t at) const {
    const uint32_t v = split.queue[at], id = split.label[v];
    uint32_t* const slot = &scratch.neighbour[at * kSlots];
    int count = 0;
    split.graph.for_each_neighbour(v, [&](uint32_t w) {
      if (split.label[w] != id) return;
      if (count < kSlots) slot[count] = scratch.place_of[w];
      ++count;
    });
    if (count > kSlots) slot[0] = kMany;
    for (; count < kSlots; ++count) slot[count] = kNone;
  }
};

/// The cell that a block splits.
struct Work {
  const SplitCell& split;
  const Scratch& scratch;
  uint32_t id;
  int64_t first, size;

  __device__ uint32_t vertex(int64_t p) const { return split.queue[first + p]; }
  __device__ uint32_t& from_first(int64_t p) const { return scratch.from_first[first + p]; }
  __device__ uint32_t& from_second(int64_t p) const { return scratch.from_second[first + p]; }
  __device__ bool is_in_second(int64_t p) const { return scratch.is_in_second(first + p); }

  /// Calls visit(place) for the neighbours in the cell until it returns true; returns whether it did.
  template <class Visit>
  __device__ bool any_neighbour(int64_t p, Visit visit) const {
    const uint32_t* const slot = &scratch.neighbour[(first + p) * kSlots];
    bool found = false;
    if (slot[0] == kMany) {
      split.graph.for_each_neighbour(vertex(p), [&](uint32_t w) {
        if (split.label[w] == id) found = found || visit(scratch.place_of[w]);
      });
      return found;
    }
    for (int k = 0; k < kSlots; ++k)
      if (slot[k] != kNone) found = visit(slot[k]) || found;
    return found;
  }
  __device__ bool touches(uint32_t v, uint32_t other) const {
    bool found = false;
    split.graph.for_each_neighbour(v, [&](uint32_t w) { found = found || split.label[w] == other; });
    return found;
  }
};

/// Smallest value among a block's threads; every thread gets it.
__device__ inline uint64_t block_min(uint64_t value, uint64_t* shared) {
  __syncthreads();
  if (threadIdx.x == 0) *shared = ~uint64_t(0);
  __syncthreads();
  value = warp_min(value);
  if ((threadIdx.x & 31) == 0) atomic_min(*shared, value);
  __syncthreads();
  return *shared;
}

/// Marks how many edges every vertex is away from a source, where that is below `limit`.
template <class IsSource, class Distance, class Limit>
__device__ inline void measure_from(const Work& work, IsSource is_source, Distance distance, Limit limit) {
  for (int64_t p = threadIdx.x; p < work.size; p += kThreads) distance(p) = is_source(work.vertex(p)) ? 0 : kFar;
  bool grew = true;
  for (uint32_t level = 0; __syncthreads_or(grew); ++level) {
    grew = false;
    for (int64_t p = threadIdx.x; p < work.size; p += kThreads) {
      if (distance(p) != kFar || level + 1 >= limit(p)) continue;
      if (!work.any_neighbour(p, [&](uint32_t q) { return atomic_load(distance(q)) == level; })) continue;
      distance(p) = level + 1;
      grew = true;
    }
  }
}

/// The vertex nearest to the seed, of a fixed one among those on the border; the smallest of equals.
__device__ inline uint32_t nearest_to_seed(const Work& work, uint64_t* shared) {
  uint64_t nearest = ~uint64_t(0), best = kNone;
  const PointQ8 seed = work.split.seed_position[work.id];
  for (int64_t p = threadIdx.x; p < work.size; p += kThreads) {
    const uint32_t v = work.vertex(p);
    if (!work.split.may_be_source(work.id, v)) continue;
    const uint64_t d = uint64_t(distance_sq_q16(work.split.vertex_position[v], seed));
    if (d < nearest || (d == nearest && v < best)) nearest = d, best = v;
  }
  const uint64_t least = block_min(nearest, shared);
  return uint32_t(block_min(nearest == least ? best : uint64_t(kNone), shared));
}

/// The vertex of the most edges from where distances begin, among others that touch the requested cell if there are
/// any; the smallest of equals.
template <class Distance>
__device__ inline uint32_t farthest(const Work& work, Distance distance, uint64_t* shared) {
  const uint32_t touching = work.split.request[work.id];
  uint64_t anywhere = ~uint64_t(0), at_other = ~uint64_t(0);  // ~distance << 32 | vertex
  for (int64_t p = threadIdx.x; p < work.size; p += kThreads) {
    const uint32_t v = work.vertex(p);
    const uint64_t key = uint64_t(~distance(p)) << 32 | v;
    anywhere = key < anywhere ? key : anywhere;
    const bool is_source = distance(p) == 0;
    if (touching != kSplitAnywhere && !is_source && key < at_other && work.touches(v, touching)) at_other = key;
  }
  anywhere = block_min(anywhere, shared);
  at_other = block_min(at_other, shared);
  return uint32_t(at_other != ~uint64_t(0) ? at_other : anywhere);
}

/// Sizes and Euler numbers of both halves.
__device__ inline void measure_halves(const Work& work, int64_t i, bool keeps_first, uint32_t* size, int32_t* euler) {
  __syncthreads();
  if (threadIdx.x < 2) size[threadIdx.x] = 0, euler[threadIdx.x] = 0;
  __syncthreads();
  const SplitCell& split = work.split;
  uint32_t all = 0, in_new = 0;
  int32_t euler_all = 0, euler_new = 0;
  for (int64_t p = threadIdx.x; p < work.size; p += kThreads) {
    const uint32_t v = work.vertex(p);
    const bool side = work.is_in_second(p);
    int32_t sum = 1;
    const auto is_same = [&](uint32_t w) {
      return split.label[w] == work.id && work.is_in_second(work.scratch.place_of[w]) == side;
    };
    split.graph.for_each_corner(v, [&](uint32_t next, uint32_t last) {
      if (next < v || !is_same(next)) return;
      --sum;
      if (last > v && is_same(last)) ++sum;
    });
    if (split.graph.is_on_border(v) && split.graph.border_before[v] > v && is_same(split.graph.border_before[v])) --sum;
    ++all;
    euler_all += sum;
    if (side == keeps_first) ++in_new, euler_new += sum;
  }
  atomic_add(size[0], all - in_new);
  atomic_add(size[1], in_new);
  atomic_add(euler[0], euler_all - euler_new);
  atomic_add(euler[1], euler_new);
  __syncthreads();
  if (threadIdx.x != 0) return;
  split.cells.size[work.id] = size[0];
  split.cells.euler[work.id] = euler[0];
  split.half[i].size = size[1];
  split.half[i].euler = euler[1];
}

/// A vertex goes to the source that is fewer edges away, so distances to the second one matter only where they are
/// smaller.
__global__ void __launch_bounds__(kThreads) split_in_blocks(int64_t count, SplitCell split, Scratch scratch) {
  __shared__ uint64_t least;
  __shared__ uint32_t size[2];
  __shared__ int32_t euler[2];
  const auto no_limit = [](int64_t) { return kFar; };
  for (int64_t i = blockIdx.x; i < count; i += gridDim.x) {
    const Work work = {split, scratch, split.cell[i], split.first[i], split.first[i + 1] - split.first[i]};
    const auto from_first = [&](int64_t p) -> uint32_t& { return work.from_first(p); };
    const auto from_second = [&](int64_t p) -> uint32_t& { return work.from_second(p); };
    const bool is_fixed = split.cells.is_fixed(work.id);
    const uint32_t kept = nearest_to_seed(work, &least);
    uint32_t first_source = kept;
    if (!is_fixed) {
      measure_from(
          work, [&](uint32_t v) { return v == kept; }, from_first, no_limit);
      first_source = farthest(work, from_first, &least);
    }
    const auto is_first_source = [&](uint32_t v) { return is_fixed ? split.graph.is_on_border(v) : v == first_source; };
    measure_from(work, is_first_source, from_first, no_limit);
    const uint32_t second_source = farthest(work, from_first, &least);
    measure_from(
        work, [&](uint32_t v) { return v == second_source; }, from_second, from_first);
    __syncthreads();
    const bool keeps_first = !work.is_in_second(scratch.place_of[kept]);
    measure_halves(work, i, keeps_first, size, euler);
    if (threadIdx.x == 0) {
      split.cells.root[work.id] = kept;
      split.half[i].seed_vertex = keeps_first ? second_source : first_source;
    }
  }
}

__global__ void __launch_bounds__(kThreads) apply_in_blocks(int64_t count, ApplySplit apply, Scratch scratch) {
  for (int64_t i = blockIdx.x; i < count; i += gridDim.x) {
    const uint32_t id = apply.new_id[i];
    const bool takes_second = scratch.is_in_second(apply.first[i] + scratch.place_of[apply.half[i].seed_vertex]);
    for (int64_t at = apply.first[i] + threadIdx.x; at < apply.first[i + 1]; at += kThreads)
      if (scratch.is_in_second(at) == takes_second) apply.label[apply.queue[at]] = id;
    if (threadIdx.x != 0) continue;
    apply.cells.root[id] = apply.half[i].seed_vertex;
    apply.cells.size[id] = apply.half[i].size;
    apply.cells.euler[id] = apply.half[i].euler;
    apply.seeds.put(id, apply.half[i].seed_vertex);
  }
}

}  // namespace split_kernels

struct SplitCellsByBlocks {
  static void run(CudaExecutor& exec, int64_t count, const SplitCell& split, const ApplySplit& apply) {
    using namespace split_kernels;
    const int64_t members = split.queue.size, vertices = split.label.size;
    Buffer<uint32_t> place_of = exec.make<uint32_t>(vertices), split_of = exec.make<uint32_t>(split.cells.size.size),
                     cursor = exec.make<uint32_t>(count), neighbour = exec.make<uint32_t>(members * kSlots),
                     from_first = exec.make<uint32_t>(members), from_second = exec.make<uint32_t>(members);
    const Scratch scratch = {place_of.view(),  split_of.view(),   cursor.view(),
                             neighbour.view(), from_first.view(), from_second.view()};
    exec.for_each("number splits", count, NumberSplits{split.cell, split_of.view(), cursor.view()});
    exec.for_each("list members", vertices, ListMembers{split, scratch});
    exec.for_each("list neighbours", members, ListNeighbours{split, scratch});
    const unsigned blocks = unsigned(count < 65536 ? count : 65536);
    split_in_blocks<<<blocks, kThreads, 0, exec.stream()>>>(count, split, scratch);
    exec.check("split cells");
    apply_in_blocks<<<blocks, kThreads, 0, exec.stream()>>>(count, apply, scratch);
    exec.check("apply splits");
  }
};

}  // namespace isoshell::dual
