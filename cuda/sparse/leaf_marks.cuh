// Leaves of a lattice as one bit each, in canonical order: marking them is an atomic or, and a scan over the counts of
// the blocks gives the sorted list and its index without a sort.
#pragma once

#include <cstddef>
#include <cstring>

#include "cuda/runtime/executor_cuda.cuh"
#include "cuda/runtime/warp.cuh"
#include "voxel/leaf.h"

namespace isoshell {
namespace leaf_marks {

constexpr int kWords = 64;  ///< of a block of 16^3 leaves

/// Blocks of the dense table by their place in canonical order: upper nodes (32^3 blocks) x-major within root tiles,
/// blocks x-major within an upper node. An upper node is a root tile, so there are two levels only.
struct BlockOrder {
  int32_t dims[3];

  ISOSHELL_HD int64_t count() const { return int64_t(dims[0]) * dims[1] * dims[2]; }
  ISOSHELL_HD int32_t width(int axis, int32_t block) const {
    const int32_t left = dims[axis] - (block & ~31);
    return left < 32 ? left : 32;
  }
  ISOSHELL_HD uint32_t place(int32_t x, int32_t y, int32_t z) const {
    const int32_t wx = width(0, x), wy = width(1, y), wz = width(2, z);
    const uint32_t before_x = uint32_t(x & ~31) * uint32_t(dims[1] * dims[2]);
    const uint32_t before_y = uint32_t(wx) * uint32_t(y & ~31) * uint32_t(dims[2]);
    const uint32_t before_z = uint32_t(wx * wy) * uint32_t(z & ~31);
    return before_x + before_y + before_z + uint32_t(((x & 31) * wy + (y & 31)) * wz + (z & 31));
  }
};

/// What a kernel marks leaves in.
struct Marks {
  BlockOrder order;
  uint64_t* words;

  ISOSHELL_HD bool inside(int32_t x, int32_t y, int32_t z) const {
    return x >= 0 && y >= 0 && z >= 0 && x < order.dims[0] * 16 && y < order.dims[1] * 16 && z < order.dims[2] * 16;
  }
  /// Leaf coordinates inside the lattice.
  __device__ void mark(int32_t x, int32_t y, int32_t z) const {
    const int bit = (x & 15) << 8 | (y & 15) << 4 | (z & 15);
    uint64_t* word = words + (int64_t(order.place(x >> 4, y >> 4, z >> 4)) * kWords + (bit >> 6));
    const unsigned long long flag = 1ull << (bit & 63);
    if (!(*const_cast<volatile uint64_t*>(word) & flag)) atomicOr(reinterpret_cast<unsigned long long*>(word), flag);
  }
};

/// Leaves of a block in the low half, 1 in the high half where there is one; by place.
constexpr int64_t kOneBlock = int64_t(1) << 32;

/// A warp a block.
static __global__ void count_leaves(BlockOrder order, const uint64_t* words, View<int64_t> count) {
  const int64_t place = cuda_steps::thread_number() >> 5;
  const int lane = threadIdx.x & 31;
  if (place > order.count()) return;
  int leaves = 0;
  if (place < order.count()) {
    const ulonglong2 pair = reinterpret_cast<const ulonglong2*>(words + place * kWords)[lane];
    leaves = __popcll(pair.x) + __popcll(pair.y);
  }
  leaves = warp_sum(leaves);
  if (lane == 0) count[place] = leaves ? kOneBlock + leaves : 0;
}

/// A warp a block of the table.
static __global__ void list_leaves(BlockOrder order, const uint64_t* words, View<const int64_t> before,
                                   View<uint32_t> block_table, View<LeafBlock> blocks, View<uint64_t> leaf_keys) {
  const int64_t t = cuda_steps::thread_number() >> 5;
  const int lane = threadIdx.x & 31;
  if (t >= order.count()) return;
  const int32_t z = int32_t(t % order.dims[2]), y = int32_t(t / order.dims[2] % order.dims[1]),
                x = int32_t(t / order.dims[2] / order.dims[1]);
  const int64_t place = order.place(x, y, z), start = before[place];
  if (before[place + 1] == start) {
    if (lane == 0) block_table[t] = kNone;
    return;
  }
  const uint32_t number = uint32_t(start >> 32), first_leaf = uint32_t(start);
  const ulonglong2 pair = reinterpret_cast<const ulonglong2*>(words + place * kWords)[lane];
  const int low = __popcll(pair.x), both = low + __popcll(pair.y);
  const int rank = warp_sum_before(both);
  LeafBlock& block = blocks[number];
  block.word[2 * lane] = pair.x;
  block.word[2 * lane + 1] = pair.y;
  block.before[2 * lane] = uint16_t(rank);
  block.before[2 * lane + 1] = uint16_t(rank + low);
  constexpr size_t kEnd = offsetof(LeafBlock, before) + sizeof(LeafBlock::before);
  if (lane == 0) {
    block.first_leaf = first_leaf;
    memset(reinterpret_cast<char*>(&block) + kEnd, 0, sizeof(LeafBlock) - kEnd);  // copies read the padding, too
    block_table[t] = number;
  }
  const uint64_t key = leaf_key({x * 16, y * 16, z * 16});
  int64_t at = int64_t(first_leaf) + rank;
  for (uint64_t bits = pair.x; bits; bits &= bits - 1) leaf_keys[at++] = key | uint64_t(lane * 128 + lowest_bit(bits));
  for (uint64_t bits = pair.y; bits; bits &= bits - 1)
    leaf_keys[at++] = key | uint64_t(lane * 128 + 64 + lowest_bit(bits));
}

}  // namespace leaf_marks

/// Marks of all leaves of a lattice.
class LeafMarks {
 public:
  LeafMarks(CudaExecutor& exec, const int32_t block_dims[3])
      : order_{{block_dims[0], block_dims[1], block_dims[2]}},
        words_(exec.make<uint64_t>(order_.count() * leaf_marks::kWords)),
        count_(exec.make<int64_t>(order_.count() + 2)) {
    const auto clear = [&](void* data, int64_t bytes) {
      require_success(cudaMemsetAsync(data, 0, size_t(bytes), exec.stream()), "clear marks");
    };
    clear(words_.data(), words_.size_bytes());
    clear(counter(), sizeof(int64_t));
  }
  leaf_marks::Marks marks() { return {order_, words_.data()}; }
  /// A number for the kernels that mark, 0 at the start, which list() reads back with its own.
  unsigned long long* counter() { return reinterpret_cast<unsigned long long*>(count_.data() + order_.count() + 1); }
  int64_t counted() const { return counted_; }

  /// The set of the marked leaves: everything but masks and first. Waits for the device once.
  VoxelSet list(CudaExecutor& exec) {
    using namespace leaf_marks;
    VoxelSet set;
    for (int axis = 0; axis < 3; ++axis) set.block_dims[axis] = order_.dims[axis];
    const View<int64_t> count = count_.view().part(0, order_.count() + 1);
    const unsigned warps = cuda_steps::blocks_for(count.size * 32);
    count_leaves<<<warps, cuda_steps::kThreads, 0, exec.stream()>>>(order_, words_.data(), count);
    exclusive_scan_async(exec.device(), count);
    struct Totals {
      int64_t leaves, counter;
    };
    const View<const Totals> totals = {reinterpret_cast<const Totals*>(count.data + order_.count()), 1};
    const Totals total = exec.value(totals, 0);
    counted_ = total.counter;
    set.block_table = exec.make<uint32_t>(order_.count());
    set.blocks = exec.make<LeafBlock>(total.leaves >> 32);
    set.leaf_key = exec.make<uint64_t>(total.leaves & 0xffffffff);
    list_leaves<<<warps, cuda_steps::kThreads, 0, exec.stream()>>>(order_, words_.data(), count, set.block_table.view(),
                                                                   set.blocks.view(), set.leaf_key.view());
    exec.check("list leaves");
    return set;
  }

 private:
  leaf_marks::BlockOrder order_;
  Buffer<uint64_t> words_;
  Buffer<int64_t> count_;
  int64_t counted_ = 0;
};

}  // namespace isoshell
