// The executor's words that count: scans, lists of what is kept, sums. One launch each, which also gives its number to
// the host: a run asks hundreds of times, mostly of few elements, and a launch costs more than what it does.
//
// Blocks work on tiles and look back at the sums of the tiles before (D. Merrill, M. Garland, Single-pass parallel
// prefix scan with decoupled look-back, 2016). Marks of earlier scans stay in the tiles: each scan has its own number,
// so that nothing has to clear them.
#pragma once

#include <algorithm>
#include <cstdint>

#include "cuda/runtime/device_stream.h"
#include "cuda/runtime/host_bell.cuh"
#include "cuda/runtime/warp.cuh"
#include "isoshell/advanced/buffer.h"

namespace isoshell::scan_kernels {

constexpr int kWarps = 8, kThreads = 32 * kWarps;
/// Elements of a thread: one where there are few, so that all are asked for at once.
constexpr int per_thread(bool few) { return few ? 1 : 8; }
inline bool are_few(int64_t count) { return count <= 1 << 15; }
inline unsigned tiles_for(int64_t count) { return blocks_for(count, kThreads * per_thread(are_few(count))); }

/// The mark that says of which kind the sum in a tile's state is. Zero, and marks of other scans, mean none.
__device__ inline uint64_t mark_of(const ScanTiles& tiles, bool is_prefix) { return tiles.number << 1 | is_prefix; }

__device__ inline void write_state(TileState* to, uint64_t sum, uint64_t mark) {
  asm volatile("st.relaxed.gpu.global.v2.u64 [%0], {%1, %2};" ::"l"(to), "l"(sum), "l"(mark) : "memory");
}
__device__ inline TileState read_state(const TileState* from) {
  TileState s;
  asm volatile("ld.relaxed.gpu.global.v2.u64 {%0, %1}, [%2];" : "=l"(s.sum), "=l"(s.mark) : "l"(from) : "memory");
  return s;
}

/// Sum of the tiles before the block's, whose own sum is `own`. By one whole warp; every lane gets it.
__device__ inline uint64_t sum_of_tiles_before(const ScanTiles& tiles, uint64_t own) {
  const int64_t tile = blockIdx.x;
  const int lane = int(threadIdx.x) & 31;
  if (lane == 0) write_state(tiles.state + tile, own, mark_of(tiles, tile == 0));
  uint64_t before = 0;
  for (int64_t last = tile - 1; last >= 0; last -= 32) {
    TileState s{0, mark_of(tiles, true)};  // in front of the first tile
    if (last - lane >= 0) {
      do {
        s = read_state(tiles.state + last - lane);
      } while (s.mark >> 1 != tiles.number);
    }
    const unsigned prefixes = __ballot_sync(kWholeWarp, s.mark & 1);
    const int nearest = prefixes ? __ffs(int(prefixes)) - 1 : 31;
    before += warp_sum(lane <= nearest ? s.sum : 0);
    if (prefixes) break;
  }
  if (lane == 0 && tile > 0) write_state(tiles.state + tile, before + own, mark_of(tiles, true));
  return before;
}

/// Sum of the warps of all tiles before the warp, of which each lane knows its own warp's sum. Every thread of the
/// block calls it; `total` becomes the sum up to the block's end.
__device__ inline uint64_t sum_of_warps_before(const ScanTiles& tiles, uint64_t of_warp, uint64_t& total) {
  __shared__ uint64_t sum[kWarps];
  __shared__ uint64_t tiles_before, of_block;
  const int lane = int(threadIdx.x) & 31, warp = int(threadIdx.x) >> 5;
  if (lane == 0) sum[warp] = of_warp;
  __syncthreads();
  if (warp == 0) {
    const uint64_t own = lane < kWarps ? sum[lane] : 0, until = warp_sum_until(own);
    if (lane < kWarps) sum[lane] = until - own;
    const uint64_t all = __shfl_sync(kWholeWarp, until, 31), before = sum_of_tiles_before(tiles, all);
    if (lane == 0) tiles_before = before, of_block = all;
  }
  __syncthreads();
  total = tiles_before + of_block;
  return tiles_before + sum[warp];
}

/// To the host, or, where no bell is given, to wherever it points; nowhere if it is null.
template <class T>
__device__ inline void give(T* to, T number, const HostBell& bell) {
  if (to) *to = number;
  if (bell.word) ring(bell);
}
__device__ inline bool ends_scan() { return blockIdx.x == gridDim.x - 1 && threadIdx.x == 0; }

/// Of a tile's elements, which warps take kPerThread rows of 32.
template <int kPerThread>
__device__ inline int64_t first_of_warp() {
  return (int64_t(blockIdx.x) * kWarps + (threadIdx.x >> 5)) * 32 * kPerThread;
}

/// out[i]: the sum of the terms before i, or up to i. Where out has one place more than there are terms, it gets the
/// sum of all. Terms may lie where the sums go.
template <int kPerThread, bool kInclusive, class T, class Term>
__global__ void __launch_bounds__(kThreads)
    scan(int64_t count, Term term, View<T> out, ScanTiles tiles, T* total, HostBell bell) {
  const int lane = int(threadIdx.x) & 31;
  const int64_t first = first_of_warp<kPerThread>() + lane;
  T value[kPerThread];
#pragma unroll
  for (int k = 0; k < kPerThread; ++k) value[k] = first + 32 * k < count ? T(term(first + 32 * k)) : T(0);
  T until = 0;  // of the rows before
#pragma unroll
  for (int k = 0; k < kPerThread; ++k) {
    const T own = value[k], here = warp_sum_until(own);
    value[k] = until + (kInclusive ? here : T(here - own));
    until += __shfl_sync(kWholeWarp, here, 31);
  }
  uint64_t all;
  const T before = T(sum_of_warps_before(tiles, uint64_t(until), all));
#pragma unroll
  for (int k = 0; k < kPerThread; ++k)
    if (first + 32 * k < count) out[first + 32 * k] = before + value[k];
  if (!ends_scan()) return;
  if (out.size > count) out[count] = T(all);
  give(total, T(all), bell);
}

template <class T>
struct ValueAt {
  View<const T> values;
  __device__ T operator()(int64_t i) const { return values[i]; }
};

/// Enqueues a scan; what went wrong with the launch, the caller asks for.
template <bool kInclusive, class T, class Term>
void launch_scan(DeviceStream& stream, int64_t count, Term term, View<T> out, T* total, HostBell bell) {
  const auto kernel =
      are_few(count) ? scan<per_thread(true), kInclusive, T, Term> : scan<per_thread(false), kInclusive, T, Term>;
  const unsigned tiles = tiles_for(std::max<int64_t>(count, 1));
  kernel<<<tiles, kThreads, 0, stream.stream()>>>(count, term, out, stream.next_scan(tiles), total, bell);
}

/// Bits that say which of the warp's elements are kept: a word a row, in the first lanes.
template <int kPerThread, class Keep>
__device__ inline uint32_t kept_of_warp(int64_t first, int64_t count, Keep& keep) {
  const int lane = int(threadIdx.x) & 31;
  uint32_t word = 0;
#pragma unroll
  for (int k = 0; k < kPerThread; ++k) {
    const int64_t i = first + 32 * k + lane;
    const uint32_t bits = __ballot_sync(kWholeWarp, i < count && bool(keep(i)));
    if (lane == k) word = bits;
  }
  return word;
}

/// The numbers of the elements that are kept, ascending.
template <int kPerThread, class Keep>
__global__ void __launch_bounds__(kThreads)
    select(int64_t count, Keep keep, uint32_t* out, ScanTiles tiles, uint32_t* total, HostBell bell) {
  const int lane = int(threadIdx.x) & 31;
  const int64_t first = first_of_warp<kPerThread>();
  const uint32_t word = kept_of_warp<kPerThread>(first, count, keep);
  const uint32_t kept = uint32_t(__popc(word)), until = warp_sum_until(kept);
  uint64_t all;
  const uint64_t before = sum_of_warps_before(tiles, __shfl_sync(kWholeWarp, until, 31), all);
  const uint32_t at = uint32_t(before) + until - kept;
#pragma unroll
  for (int k = 0; k < kPerThread; ++k) {
    const uint32_t bits = __shfl_sync(kWholeWarp, word, k), place = __shfl_sync(kWholeWarp, at, k);
    if (bits >> lane & 1) out[place + lanes_before(bits)] = uint32_t(first + 32 * k + lane);
  }
  if (ends_scan()) give(total, uint32_t(all), bell);
}

/// The same in two steps, for so many that a list of all might not find room: bits, and how many come before each word.
template <int kPerThread, class Keep>
__global__ void __launch_bounds__(kThreads) mark_kept(int64_t count, Keep keep, View<uint32_t> words, uint32_t* rank,
                                                      ScanTiles tiles, uint32_t* total, HostBell bell) {
  const int lane = int(threadIdx.x) & 31;
  const int64_t first = first_of_warp<kPerThread>(), w = first / 32 + lane;
  const uint32_t word = kept_of_warp<kPerThread>(first, count, keep);
  const uint32_t kept = uint32_t(__popc(word)), until = warp_sum_until(kept);
  uint64_t all;
  const uint64_t before = sum_of_warps_before(tiles, __shfl_sync(kWholeWarp, until, 31), all);
  if (lane < kPerThread && w < words.size) {
    words[w] = word;
    rank[w] = uint32_t(before) + until - kept;
  }
  if (ends_scan()) give(total, uint32_t(all), bell);
}

template <class Term>
__global__ void __launch_bounds__(kThreads)
    sum(int64_t count, Term term, SumState* state, int64_t* out, HostBell bell) {
  int64_t part = 0;
  for (int64_t i = int64_t(blockIdx.x) * kThreads + threadIdx.x; i < count; i += int64_t(gridDim.x) * kThreads)
    part += int64_t(term(i));
  part = warp_sum(part);
  if ((threadIdx.x & 31) == 0 && part != 0) atomicAdd(&state->sum, (unsigned long long)part);
  __syncthreads();
  if (threadIdx.x != 0) return;
  __threadfence();
  if (atomicAdd(&state->blocks_done, 1u) != gridDim.x - 1) return;
  __threadfence();
  const int64_t all = int64_t(atomicExch(&state->sum, 0ull));
  state->blocks_done = 0;
  give(out, all, bell);
}

}  // namespace isoshell::scan_kernels
