// The rounds of optimize_mesh (see stages/optimize/optimize_body.h) on the device without a look of the host at each:
// undoing and searching run to their end in one cooperative launch; flips are launched several rounds at once, since a
// round that finds nothing to do changes nothing.
#pragma once

#include <cooperative_groups.h>

#include "cuda/relax/group_walk.cuh"
#include "cuda/runtime/executor_cuda.cuh"
#include "cuda/runtime/warp.cuh"
#include "stages/optimize/optimize_body.h"

namespace isoshell::optimize {

constexpr int kRoundsPerLook = 3;  ///< of flips

namespace device_steps {

/// Lists the flips that go ahead, in any order: they touch nothing in common.
template <class Key>
struct ListWinners {
  WinsItsVertices<Key> wins;
  View<uint32_t> winners, count;  ///< count: of this round
  ISOSHELL_HD void operator()(int64_t h) const {
    if (wins(h)) winners[atomic_fetch_add(count[0], 1u)] = uint32_t(h);
  }
};
struct FlipWinners {
  Flip flip;
  View<const uint32_t> count;
  ISOSHELL_HD void operator()(int64_t i) const {
    if (i < int64_t(count[0])) flip(i);
  }
};

constexpr int kThreads = 256;
constexpr int kBlocks = 2;  ///< a multiprocessor: all of a kernel's blocks run at once, and wait for one another

/// Calls each(i) for what of 0 .. count - 1 is this thread's of the grid.
template <class Each>
__device__ inline void for_each_of_grid(int64_t count, Each each) {
  for (int64_t i = int64_t(blockIdx.x) * kThreads + threadIdx.x; i < count; i += int64_t(gridDim.x) * kThreads) each(i);
}

/// The whole of PlainUndoHarm. Three words of `some`, one a round: was a vertex restored?
__global__ void __launch_bounds__(kThreads, kBlocks)
    undo_in_rounds(MarkHarmed mark, RestoreHarmed restore, uint32_t* some) {
  const auto grid = cooperative_groups::this_grid();
  const bool is_first = blockIdx.x == 0 && threadIdx.x == 0;
  for_each_of_grid(restore.harmed.size, [&](int64_t v) { restore.harmed[v] = 0; });
  if (is_first) some[0] = 0;
  for (int round = 0;; round = (round + 1) % 3) {
    grid.sync();
    for_each_of_grid(mark.triangles.size, mark);
    grid.sync();
    bool restored = false;
    for_each_of_grid(restore.harmed.size, [&](int64_t v) {
      if (!restore.harmed[v]) return;
      restore(v);
      restore.harmed[v] = 0;
      restored = true;
    });
    if (__syncthreads_or(restored) && threadIdx.x == 0) atomic_or(some[round], 1u);
    if (is_first) some[(round + 1) % 3] = 0;
    grid.sync();
    if (!atomic_load(some[round])) return;
  }
}

/// SearchVertex by a warp: a lane tries each place, and the first of the best ones counts.
__device__ inline void search_together(const SearchVertex& search, uint32_t v) {
  static_assert(SearchVertex::kPlaces == 32, "a lane a place");
  const int lane = threadIdx.x & 31;
  const PointQ8 p = search.position[v];
  const double here = search.worst_quality(v, p, 0);
  const PointQ8 place = search.place_at(p, search.compass_at(v), lane);
  double best = search.worst_quality(v, place, here);
  int number = lane;
#pragma unroll
  for (int d = 16; d > 0; d >>= 1) {
    const double other = __shfl_xor_sync(kWholeWarp, best, d);
    const int other_number = __shfl_xor_sync(kWholeWarp, number, d);
    if (other > best || (other == best && other_number < number)) best = other, number = other_number;
  }
  if (!(best > here)) return;
  const PointQ8 to = {__shfl_sync(kWholeWarp, place.x, number), __shfl_sync(kWholeWarp, place.y, number),
                      __shfl_sync(kWholeWarp, place.z, number)};
  if (to == p) return;
  if (!search.onto_sheet) {
    if (lane == 0) search.position[v] = to;
    return;
  }
  const cuda_relax::Landing landing = cuda_relax::walk_together(search.walk, search.home[v], to, true);
  if (lane == 0) search.move_onto_sheet(v, landing.vertex, landing.point, here);
}

/// The whole of PlainSearchPositions. Chosen vertices are listed in any order, so that each has a warp: they are
/// independent. Three words of `count`, one a round: how many were chosen?
__global__ void __launch_bounds__(kThreads, kBlocks)
    search_in_rounds(SearchVertex search, View<uint32_t> poor, View<uint32_t> chosen, uint32_t* count,
                     double least_quality, int64_t locked, int rounds) {
  const auto grid = cooperative_groups::this_grid();
  const bool is_first = blockIdx.x == 0 && threadIdx.x == 0;
  if (is_first) count[0] = 0;
  for (int round = 0; round < rounds; ++round) {
    uint32_t* const count_now = count + round % 3;
    for_each_of_grid(poor.size, [&](int64_t v) { poor[v] = 0; });
    grid.sync();
    for_each_of_grid(search.mesh.triangles.size,
                     MarkPoor{search.mesh.triangles, search.position, least_quality, locked, poor});
    if (is_first) count[(round + 1) % 3] = 0;
    grid.sync();
    search.round = round;
    const MayMove may_move{search.mesh, poor, uint64_t(round)};
    for_each_of_grid(poor.size, [&](int64_t v) {
      if (may_move(v)) chosen[atomic_fetch_add(*count_now, 1u)] = uint32_t(v);
    });
    grid.sync();
    const uint32_t movers = atomic_load(*count_now);
    if (movers == 0) return;
    for_each_of_grid(32 * int64_t(movers), [&](int64_t i) { search_together(search, chosen[i / 32]); });
    grid.sync();
  }
}

/// Launches a kernel whose blocks wait for one another, for so many elements.
template <class... Parameters>
void launch_together(CudaExecutor& exec, void (*kernel)(Parameters...), int64_t elements, Parameters... parameters) {
  const unsigned blocks = exec.device().resident_blocks((elements + kThreads - 1) / kThreads, kBlocks);
  void* arguments[] = {&parameters...};
  require_success(cudaLaunchCooperativeKernel(reinterpret_cast<const void*>(kernel), dim3(blocks), dim3(kThreads),
                                              arguments, 0, exec.stream()),
                  "cudaLaunchCooperativeKernel");
}

}  // namespace device_steps

struct FlipEdgesInBatches {
  template <class Key>
  static int64_t run(CudaExecutor& exec, const Key& key, View<uint64_t> claim, int rounds) {
    using namespace device_steps;
    const int64_t half_edges = key.mesh.twin.size, most = claim.size / 4 + 1;  // a flip holds four vertices
    Buffer<uint32_t> winners = exec.make<uint32_t>(most), count = exec.make<uint32_t>(kRoundsPerLook);
    int64_t flips = 0;
    for (int left = rounds; left > 0; left -= kRoundsPerLook) {
      const int now = left < kRoundsPerLook ? left : kRoundsPerLook;
      exec.fill(count.view(), 0u);
      for (int r = 0; r < now; ++r) {
        const View<uint32_t> count_of_round = count.view().part(r, 1);
        exec.fill(claim, uint64_t(0));
        exec.for_each("claim flips", half_edges, ClaimVertices<Key>{key, claim});
        exec.for_each("list flips", half_edges, ListWinners<Key>{{key, claim}, winners.view(), count_of_round});
        exec.for_each("flip edges", most, FlipWinners{{key.mesh, winners.view()}, count_of_round});
      }
      const Buffer<uint32_t> found = count.to_host();
      for (const uint32_t n : found) flips += n;
      if (found[now - 1] == 0) break;
    }
    return flips;
  }
};

struct UndoHarmInOneLaunch {
  static void run(CudaExecutor& exec, View<const TriangleIndices> triangles, double least_quality,
                  const RestoreHarmed& restore) {
    const MarkHarmed mark{triangles, restore.before, restore.after, least_quality, restore.harmed};
    Buffer<uint32_t> some = exec.make<uint32_t>(3);
    device_steps::launch_together(exec, device_steps::undo_in_rounds, triangles.size, mark, restore, some.data());
    exec.check("undo harm");
  }
};

struct SearchPositionsInOneLaunch {
  static void run(CudaExecutor& exec, const MeshView& mesh, const WalkOntoSheet& walk, const SearchOptions& options,
                  View<PointQ8> position, View<uint32_t> home, View<uint32_t> poor) {
    const SearchVertex search{mesh, walk, {}, options.edge, options.hold, 0, options.onto_sheet, position, home};
    Buffer<uint32_t> chosen = exec.make<uint32_t>(poor.size), count = exec.make<uint32_t>(3);
    constexpr int64_t kMoversAtOnce = 4;  // a warp each: rarely more than every fourth vertex moves
    device_steps::launch_together(exec, device_steps::search_in_rounds, poor.size * 32 / kMoversAtOnce, search, poor,
                                  chosen.view(), count.data(), options.least_quality, options.locked, options.rounds);
    exec.check("search places");
  }
};

}  // namespace isoshell::optimize
