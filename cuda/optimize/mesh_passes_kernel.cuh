// Relaxation on the mesh (see stages/optimize/optimize_mesh_passes.h) on the device: all passes in one cooperative
// launch, since the steps of a pass take less time than launches.
#pragma once

#include "cuda/optimize/optimize_kernels.cuh"
#include "stages/optimize/optimize_mesh_passes.h"

namespace isoshell::optimize {

namespace device_steps {

constexpr int kMostTurns = 32;  ///< of a thread over the half-edges: a bit for each

/// The half-edge that this thread of the grid comes to in a turn.
__device__ inline int64_t half_edge_of(int turn) {
  return (int64_t(turn) * gridDim.x + blockIdx.x) * kThreads + threadIdx.x;
}

/// Flips what PlainMeshPasses flips in a pass. Half-edges that may flip, then those that do, are bits of their thread.
__device__ inline void flip_in_pass(const MeshPasses& passes, int32_t pass) {
  const auto grid = cooperative_groups::this_grid();
  const ClaimVertices<DelaunayKey> claim{delaunay_key(passes, pass), passes.claim};
  const int64_t half_edges = passes.mesh.twin.size;
  uint32_t flips = 0;
  for (int turn = 0; half_edge_of(turn) < half_edges; ++turn) {
    const int64_t h = half_edge_of(turn);
    if (!claim.key.is_beyond(uint32_t(h))) continue;
    claim(h);
    flips |= 1u << turn;
  }
  grid.sync();
  const WinsItsVertices<DelaunayKey> winner{claim.key, passes.claim};
  for (uint32_t left = flips; left != 0; left &= left - 1) {
    const int turn = __ffs(int(left)) - 1;
    if (!winner(half_edge_of(turn))) flips &= ~(1u << turn);
  }
  grid.sync();
  const FlipInPass flip{passes, pass};
  for (; flips != 0; flips &= flips - 1) flip(uint32_t(half_edge_of(__ffs(int(flips)) - 1)));
}

/// The whole of PlainMeshPasses.
__global__ void __launch_bounds__(kThreads, kBlocks) relax_in_passes(const __grid_constant__ MeshPasses passes) {
  const auto grid = cooperative_groups::this_grid();
  const int64_t vertices = passes.home.size, triangles = passes.mesh.triangles.size;
  for_each_of_grid(vertices, [&](int64_t v) { passes.claim[v] = 0; });
  for (int32_t pass = 0; pass < passes.options.passes; ++pass) {
    for_each_of_grid(triangles, MeasureCells{passes, pass});
    grid.sync();
    if (passes.flips(pass)) {
      flip_in_pass(passes, pass);
      grid.sync();
    }
    for_each_of_grid(vertices, MoveInRing{passes, pass, passes.noise_q8(pass)});
    if (passes.returns(pass))  // of vertices that this thread moved
      for_each_of_grid(vertices, WalkToTarget<ReturnOntoSheet>{passes.walk, passes.home, {passes, pass}});
    grid.sync();
  }
}

}  // namespace device_steps

struct MeshPassesInOneLaunch {
  static void run(CudaExecutor& exec, const MeshPasses& passes) {
    using namespace device_steps;
    const int64_t triangles = passes.mesh.triangles.size;
    const int64_t threads =
        int64_t(exec.device().resident_blocks((triangles + kThreads - 1) / kThreads, kBlocks)) * kThreads;
    if (3 * triangles > kMostTurns * threads) return PlainMeshPasses::run(exec, passes);
    launch_together(exec, relax_in_passes, triangles, passes);
    exec.check("relax on mesh");
  }
};

}  // namespace isoshell::optimize
