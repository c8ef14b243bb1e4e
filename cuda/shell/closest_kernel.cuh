// The kernel of the banded distance transform: each warp takes rows of leaves until there are none.
#pragma once

#include "cuda/shell/closest_row.cuh"

namespace isoshell {
namespace closest {

template <int kReach, int kBand, class Keys>
constexpr int64_t shared_bytes() {
  return int64_t(sizeof(Shared<kReach, kBand, Keys>)) * kWarps<kReach, kBand, Keys> + 4 * kTableWords<kBand>;
}

template <int kReach, int kBand, class Keys>
__global__ void __launch_bounds__(kWarps<kReach, kBand, Keys> * 32, kBand > 0 ? 4 : 1)
    closest_sites(Rows rows, const __grid_constant__ Input in, const __grid_constant__ Output out) {
  extern __shared__ uint4 memory[];
  auto* shared = reinterpret_cast<Shared<kReach, kBand, Keys>*>(memory);
  auto* table = reinterpret_cast<uint32_t*>(shared + kWarps<kReach, kBand, Keys>);
  fill_tables<kBand, Keys>(table, in.band_vox);
  __syncthreads();
  Worker<kReach, kBand, Keys> worker(in, out, shared[threadIdx.x >> 5], table);
  const uint32_t count = *rows.count;
  for (;;) {
    uint32_t row = 0;
    if ((threadIdx.x & 31) == 0) row = atomicAdd(rows.next, 1u);
    row = __shfl_sync(kWholeWarp, row, 0);
    if (row >= count) break;
    worker.run(rows.first_leaf[row], rows.leaves);
  }
  worker.finish();
}

}  // namespace closest
}  // namespace isoshell
