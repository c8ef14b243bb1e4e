// The rounds of improve_mesh (see stages/post_body.h) on the device without a look of the host at each: a round that
// finds nothing to do changes nothing, so several are launched at once.
#pragma once

#include "cuda/executor_cuda.cuh"
#include "stages/post_body.h"

namespace isoshell::post {

constexpr int kRoundsPerLook = 3;  ///< most meshes are done after two

namespace device_steps {

/// Lists the flips that go ahead, in any order: they touch nothing in common.
struct ListWinners {
  WinsItsVertices wins;
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

/// Restores what was harmed, remembers that some was, and clears the marks for the next round.
struct RestoreAndTell {
  RestoreHarmed restore;
  View<uint32_t> some;
  ISOSHELL_HD void operator()(int64_t v) const {
    if (!restore.harmed[v]) return;
    if (!atomic_load(some[0])) atomic_or(some[0], 1u);
    restore(v);
    restore.harmed[v] = 0;
  }
};

}  // namespace device_steps

inline int64_t flip_edges(CudaExecutor& exec, const FlipKey& key, View<uint64_t> claim, int rounds) {
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
      exec.for_each("claim flips", half_edges, ClaimVertices{key, claim});
      exec.for_each("list flips", half_edges, ListWinners{{key, claim}, winners.view(), count_of_round});
      exec.for_each("flip edges", most, FlipWinners{{key.mesh, winners.view()}, count_of_round});
    }
    const Buffer<uint32_t> found = count.to_host();
    for (const uint32_t n : found) flips += n;
    if (found[now - 1] == 0) break;
  }
  return flips;
}

inline void undo_harm(CudaExecutor& exec, View<const TriangleIndices> triangles, double least_merit,
                      const RestoreHarmed& restore) {
  const MarkHarmed mark{triangles, restore.before, restore.after, least_merit, restore.harmed};
  Buffer<uint32_t> some = exec.make<uint32_t>(kRoundsPerLook);
  exec.fill(restore.harmed, 0u);
  do {
    exec.fill(some.view(), 0u);
    for (int r = 0; r < kRoundsPerLook; ++r) {
      exec.for_each("mark harmed", triangles.size, mark);
      exec.for_each("restore harmed", restore.harmed.size,
                    device_steps::RestoreAndTell{restore, some.view().part(r, 1)});
    }
  } while (exec.value(View<const uint32_t>(some.view()), kRoundsPerLook - 1) != 0);
}

}  // namespace isoshell::post
