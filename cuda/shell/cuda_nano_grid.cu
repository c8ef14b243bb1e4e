// CUDA's nano_index_grid: nodes straight from the sorted leaves. The host writes what lies before them, since it knows
// NanoVDB; the device writes leaves, then lower nodes with their places in the upper ones, then the boxes on top.
#include <climits>

#include "cuda/cuda_backend.h"
#include "cuda/runtime/executor_cuda.cuh"
#include "cuda/runtime/warp.cuh"
#include "grid/nano_nodes.h"
#include "voxel/leaf.h"

namespace isoshell {
namespace {

constexpr int kThreads = 256;

/// Root tiles of a lattice, x-major, which is their canonical order.
struct RootTiles {
  static constexpr int kMost = 64;
  int32_t dims[3];

  explicit RootTiles(const int32_t block_dims[3])
      : dims{(block_dims[0] + 31) / 32, (block_dims[1] + 31) / 32, (block_dims[2] + 31) / 32} {}
  ISOSHELL_HD int count() const { return dims[0] * dims[1] * dims[2]; }
  ISOSHELL_HD int number(Voxel leaf) const {
    return ((leaf.x >> 9) * dims[1] + (leaf.y >> 9)) * dims[2] + (leaf.z >> 9);
  }
  uint64_t key(int number) const {
    return leaf_key({number / dims[2] / dims[1] << 9, number / dims[2] % dims[1] << 9, number % dims[2] << 9}) >> 27;
  }
};

struct Nodes {
  NanoNodes fields;
  NanoLayout at;
  char* bytes;
  uint8_t upper_of_tile[RootTiles::kMost];

  __device__ char* leaf(int64_t i) const { return bytes + at.first_leaf + i * kNanoLeafBytes; }
  __device__ char* lower(int64_t i) const { return bytes + at.first_lower + i * fields.lower.bytes; }
  __device__ char* upper(int64_t i) const { return bytes + at.first_upper + i * fields.upper.bytes; }
  __device__ int32_t* root_box() const { return reinterpret_cast<int32_t*>(bytes + at.root_box); }
};

struct Box {
  int32_t lo[3], hi[3];
};

__global__ void mark_root_tiles(VoxelSetView set, RootTiles tiles, uint32_t* used) {
  const int64_t b = cuda_steps::thread_number();
  if (b >= set.blocks.size) return;
  uint32_t& mark = used[tiles.number(leaf_of_key(set.leaf_key[set.blocks[b].first_leaf]))];
  if (!mark) atomicOr(&mark, 1u);
}

/// Boxes of the upper nodes and the root that every other box stretches.
__device__ void empty_boxes(const Nodes& nodes) {
  for (int t = int(threadIdx.x); t < 6 * (nodes.at.uppers + 1); t += kThreads) {
    const int i = t / 6, side = t % 6;
    int32_t* box =
        i == nodes.at.uppers ? nodes.root_box() : reinterpret_cast<int32_t*>(nodes.upper(i) + nodes.fields.upper.box);
    box[side] = side < 3 ? INT_MAX : INT_MIN;
  }
}

/// Eight lanes a leaf, each with the mask's word of its x.
__global__ void __launch_bounds__(kThreads) write_leaves(VoxelSetView set, Nodes nodes) {
  if (blockIdx.x == 0) empty_boxes(nodes);
  const int64_t thread = cuda_steps::thread_number(), l = thread >> 3;
  const int x = int(thread & 7);
  const bool some = l < nodes.at.leaves;
  const uint64_t word = some ? set.mask[l].word[x] : 0;
  const uint32_t lanes = __ballot_sync(kWholeWarp, word != 0) >> (threadIdx.x & 24) & 255;
  const uint64_t all = warp_or<8>(word);
  const uint32_t before = warp_sum_until<8>(uint32_t(__popcll(word)));
  // Voxels before words 1 to 7, nine bits each.
  const uint64_t packed = warp_or<8>(x < 7 ? uint64_t(before) << (9 * x) : uint64_t(0));
  if (!some) return;
  const uint32_t low = uint32_t(all) | uint32_t(all >> 32);
  uint32_t zs = low | low >> 16, ys = 0;
  zs = (zs | zs >> 8) & 255;
  for (int y = 0; y < 8; ++y) ys |= uint32_t((all >> (8 * y) & 255) != 0) << y;
  const auto first = [](uint32_t bits) { return __ffs(int(bits)) - 1; };
  const auto last = [](uint32_t bits) { return 31 - __clz(int(bits)); };
  const Voxel at = leaf_of_key(set.leaf_key[l]);
  auto* words = reinterpret_cast<uint64_t*>(nodes.leaf(l));
  words[kNanoLeafMask / 8 + x] = word;
  if (x == 0) words[0] = uint64_t(uint32_t(at.x * 8 + first(lanes))) | uint64_t(uint32_t(at.y * 8 + first(ys))) << 32;
  if (x == 1)
    words[1] = uint64_t(uint32_t(at.z * 8 + first(zs))) | uint64_t(last(lanes) - first(lanes)) << 32 |
               uint64_t(last(ys) - first(ys)) << 40 | uint64_t(last(zs) - first(zs)) << 48 |
               uint64_t(nodes.fields.leaf_flags) << 56;
  const int first_value = int(kNanoLeafWords / 8) + nodes.fields.first_value_word;
  if (x == 2) words[first_value] = uint64_t(set.first[l]) + 1;
  if (x == 3) words[first_value ^ 1] = nodes.fields.prefix_sums ? packed : 0;
}

__device__ Box box_of_leaf(const char* leaf) {
  const auto* corner = reinterpret_cast<const int32_t*>(leaf);
  const auto* size = reinterpret_cast<const uint8_t*>(leaf) + 12;
  Box box;
  for (int axis = 0; axis < 3; ++axis) {
    box.lo[axis] = corner[axis];
    box.hi[axis] = corner[axis] + size[axis];
  }
  return box;
}

/// Most boxes change nothing any more, so look first.
__device__ void stretch(int32_t* box, const Box& by) {
  for (int axis = 0; axis < 3; ++axis) {
    if (*const_cast<volatile int32_t*>(box + axis) > by.lo[axis]) atomicMin(box + axis, by.lo[axis]);
    if (*const_cast<volatile int32_t*>(box + 3 + axis) < by.hi[axis]) atomicMax(box + 3 + axis, by.hi[axis]);
  }
}

__device__ void clear_bytes(char* from, int64_t bytes) {
  for (int64_t i = threadIdx.x; i < bytes / 8; i += kThreads) reinterpret_cast<uint64_t*>(from)[i] = 0;
}

/// A thread block a lower node.
__global__ void __launch_bounds__(kThreads) write_lowers(VoxelSetView set, RootTiles tiles, Nodes nodes) {
  __shared__ Box shared_box;
  const int64_t b = blockIdx.x;
  const LeafBlock& block = set.blocks[b];
  const NanoNode& fields = nodes.fields.lower;
  char* lower = nodes.lower(b);
  if (threadIdx.x < 6)
    (threadIdx.x < 3 ? shared_box.lo : shared_box.hi)[threadIdx.x % 3] = threadIdx.x < 3 ? INT_MAX : INT_MIN;
  clear_bytes(lower, fields.table);
  clear_bytes(lower + fields.table + 4096 * 8, fields.bytes - fields.table - 4096 * 8);
  auto* table = reinterpret_cast<int64_t*>(lower + fields.table);
  for (int slot = int(threadIdx.x); slot < 4096; slot += kThreads) {
    const uint64_t word = block.word[slot >> 6], bit = uint64_t(1) << (slot & 63);
    int64_t child = 0;
    if (word & bit)
      child = nodes.leaf(int64_t(block.first_leaf) + block.before[slot >> 6] + __popcll(word & (bit - 1))) - lower;
    table[slot] = child;
  }
  const int64_t end = int64_t(block.first_leaf) + block.before[63] + __popcll(block.word[63]);
  Box box = {{INT_MAX, INT_MAX, INT_MAX}, {INT_MIN, INT_MIN, INT_MIN}};
  for (int64_t l = int64_t(block.first_leaf) + threadIdx.x; l < end; l += kThreads) {
    const Box leaf = box_of_leaf(nodes.leaf(l));
    for (int axis = 0; axis < 3; ++axis) {
      box.lo[axis] = min(box.lo[axis], leaf.lo[axis]);
      box.hi[axis] = max(box.hi[axis], leaf.hi[axis]);
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    box.lo[axis] = warp_min(box.lo[axis]);
    box.hi[axis] = warp_max(box.hi[axis]);
  }
  __syncthreads();
  if (threadIdx.x < 64) reinterpret_cast<uint64_t*>(lower + fields.child_mask)[threadIdx.x] = block.word[threadIdx.x];
  if ((threadIdx.x & 31) == 0)
    for (int axis = 0; axis < 3; ++axis) {
      atomicMin(&shared_box.lo[axis], box.lo[axis]);
      atomicMax(&shared_box.hi[axis], box.hi[axis]);
    }
  __syncthreads();
  if (threadIdx.x != 0) return;
  *reinterpret_cast<Box*>(lower + fields.box) = shared_box;
  const uint64_t key = set.leaf_key[block.first_leaf];
  char* upper = nodes.upper(nodes.upper_of_tile[tiles.number(leaf_of_key(key))]);
  const int slot = int(key >> 12) & 32767;
  reinterpret_cast<int64_t*>(upper + nodes.fields.upper.table)[slot] = lower - upper;
  atomicOr(reinterpret_cast<unsigned long long*>(upper + nodes.fields.upper.child_mask) + (slot >> 6),
           1ull << (slot & 63));
  stretch(reinterpret_cast<int32_t*>(upper + nodes.fields.upper.box), shared_box);
  stretch(nodes.root_box(), shared_box);
}

/// The same two operations as on the host, on the same numbers.
__global__ void write_world_box(Nodes nodes, double shift_x, double shift_y, double shift_z, double voxel_size) {
  const double shift[3] = {shift_x, shift_y, shift_z};
  auto* world = reinterpret_cast<double*>(nodes.bytes + nodes.at.world_box);
  for (int axis = 0; axis < 3; ++axis) {
    world[axis] = shift[axis] + voxel_size * nodes.root_box()[axis];
    world[3 + axis] = shift[axis] + voxel_size * (nodes.root_box()[3 + axis] + 1.0);
  }
}

/// Marks of the root tiles that have leaves. Waits for the device where there are several.
void find_root_tiles(CudaExecutor& exec, const VoxelSetView& set, const RootTiles& tiles,
                     bool (&used)[RootTiles::kMost]) {
  if (tiles.count() == 1) {
    used[0] = set.blocks.size > 0;
    return;
  }
  struct Marks {
    uint32_t tile[RootTiles::kMost];
  };
  Buffer<Marks> marks = exec.make<Marks>(1);
  require_success(cudaMemsetAsync(marks.data(), 0, sizeof(Marks), exec.stream()), "clear");
  if (set.blocks.size > 0)
    mark_root_tiles<<<cuda_steps::blocks_for(set.blocks.size), cuda_steps::kThreads, 0, exec.stream()>>>(
        set, tiles, marks.data()->tile);
  exec.check("mark root tiles");
  const Marks found = exec.value(View<const Marks>(marks.view()), 0);
  for (int i = 0; i < tiles.count(); ++i) used[i] = found.tile[i] != 0;
}

Buffer<std::byte> build(CudaExecutor& exec, const VoxelSet& voxels, const LatticeFrame& frame, const char* name) {
  const VoxelSetView set = voxels.view();
  const RootTiles tiles(set.block_dims);
  if (tiles.count() > RootTiles::kMost)
    throw Error(ErrorCode::usage, "nano_shell",
                "the lattice spans " + std::to_string(tiles.count()) + " root tiles; there may be at most " +
                    std::to_string(RootTiles::kMost));
  bool used[RootTiles::kMost] = {};
  find_root_tiles(exec, set, tiles, used);
  Nodes nodes = {};
  uint64_t upper_key[RootTiles::kMost];
  int64_t uppers = 0;
  for (int i = 0; i < tiles.count(); ++i) {
    if (!used[i]) continue;
    nodes.upper_of_tile[i] = uint8_t(uppers);
    upper_key[uppers++] = tiles.key(i);
  }
  nodes.fields = nano_nodes();
  nodes.at = nano_layout(voxels.leaf_count(), set.blocks.size, uppers, voxels.voxel_count());
  const Buffer<std::byte> head = nano_head(nodes.at, upper_key, frame, name);
  Buffer<std::byte> bytes = exec.make<std::byte>(nodes.at.end);
  exec.device().copy_to_device(bytes.data(), head.data(), head.size_bytes());
  if (nodes.at.leaves == 0) {
    exec.device().synchronize();  // the head ends with this call
    return bytes;
  }
  nodes.bytes = reinterpret_cast<char*>(bytes.data());
  require_success(cudaMemsetAsync(nodes.bytes + nodes.at.first_upper, 0,
                                  size_t(nodes.at.first_lower - nodes.at.first_upper), exec.stream()),
                  "clear upper nodes");
  write_leaves<<<blocks_for(nodes.at.leaves * 8, kThreads), kThreads, 0, exec.stream()>>>(set, nodes);
  write_lowers<<<unsigned(nodes.at.lowers), kThreads, 0, exec.stream()>>>(set, tiles, nodes);
  write_world_box<<<1, 1, 0, exec.stream()>>>(nodes, nano_shift(frame, 0), nano_shift(frame, 1), nano_shift(frame, 2),
                                              frame.voxel_size);
  exec.check("write nodes");
  return bytes;
}

}  // namespace

Buffer<std::byte> CudaBackend::nano_index_grid(const VoxelSet& voxels, const LatticeFrame& frame, const char* name,
                                               Context& context) const {
  CudaExecutor exec(context, "nano_shell");
  const OnDevice<VoxelSet> here(exec, voxels);
  return build(exec, *here, frame, name);
}

}  // namespace isoshell
