// CUDA's build_shell: leaves within reach of the sites, their masks, and with the counts in hand their values, which go
// straight to their places.
#include "cuda/cuda_backend.h"
#include "cuda/runtime/executor_cuda.cuh"
#include "cuda/shell/closest_kernel.cuh"
#include "cuda/shell/shell_masks.h"
#include "cuda/sparse/leaf_marks.cuh"
#include "voxel/closest.h"

namespace isoshell {
namespace {

constexpr int kMarkThreads = 256;

/// Distance along one axis from place `at` of a leaf to the leaf `leaves` away.
__device__ int gap(int at, int leaves) { return leaves > 0 ? 8 * leaves - at : leaves < 0 ? at - 8 * leaves - 7 : 0; }

/// The leaves around a leaf, all of the cube where it is small, else those that the band may reach.
template <int kReach>
struct Neighbours {
  static constexpr int kSpan = 2 * kReach + 1, kMost = kSpan * kSpan * kSpan;
  static constexpr bool kAll = kReach == 1;
  int3 listed[kAll ? 1 : kMost];
  int count;

  __device__ static int3 of_cube(int n) {
    return {n / (kSpan * kSpan) - kReach, n / kSpan % kSpan - kReach, n % kSpan - kReach};
  }
  __device__ int size() const { return kAll ? kMost : count; }
  __device__ int3 operator[](int n) const { return kAll ? of_cube(n) : listed[n]; }

  /// By a whole thread block.
  __device__ void list(int band) {
    if (kAll) return;
    if (threadIdx.x == 0) count = 0;
    __syncthreads();
    for (int n = int(threadIdx.x); n < kMost; n += kMarkThreads) {
      const int3 by = of_cube(n);
      const int gx = closest::leaf_gap(by.x), gy = closest::leaf_gap(by.y), gz = closest::leaf_gap(by.z);
      if (gx * gx + gy * gy + gz * gz <= band * band) listed[atomicAdd(&count, 1)] = by;
    }
    __syncthreads();
  }
};

/// Marks every leaf that has a voxel within the band of a site: exactly the leaves of the shell. A warp a leaf of
/// sites, a lane a neighbour; the table says which voxels of a leaf are close enough to which neighbour.
template <int kReach>
__global__ void __launch_bounds__(kMarkThreads) mark_reached(VoxelSetView sites, int band, leaf_marks::Marks marks) {
  __shared__ uint64_t table[8][Neighbours<kReach>::kMost];
  __shared__ Neighbours<kReach> neighbours;
  neighbours.list(band);
  const int count = neighbours.size();
  for (int i = int(threadIdx.x); i < 8 * count; i += kMarkThreads) {
    const int3 by = neighbours[i % count];
    const int gx = gap(i / count, by.x);
    uint64_t near = 0;
    for (int y = 0; y < 8; ++y)
      for (int z = 0; z < 8; ++z) {
        const int gy = gap(y, by.y), gz = gap(z, by.z);
        near |= uint64_t(gx * gx + gy * gy + gz * gz <= band * band) << (8 * y + z);
      }
    table[i / count][i % count] = near;
  }
  __syncthreads();
  const int lane = int(threadIdx.x & 31);
  const int64_t step = int64_t(gridDim.x) * (kMarkThreads / 32);
  for (int64_t l = cuda_steps::thread_number() >> 5; l < sites.leaf_key.size; l += step) {
    const Voxel at = leaf_of_key(sites.leaf_key[l]);
    uint64_t word[8];
    for (int x = 0; x < 8; ++x) word[x] = sites.mask[l].word[x];
    for (int n = lane; n < count; n += 32) {
      uint64_t near = 0;
      for (int x = 0; x < 8; ++x) near |= word[x] & table[x][n];
      const int3 by = neighbours[n];
      const int x = at.x + by.x, y = at.y + by.y, z = at.z + by.z;
      if (near && marks.inside(x, y, z)) marks.mark(x, y, z);
    }
  }
}

/// Lists the first leaf of every row of `leaves` along x that has any. The order of the list does not matter.
__global__ void list_rows(VoxelSetView shell, int leaves, View<uint32_t> rows, uint32_t* count) {
  const int64_t l = cuda_steps::thread_number();
  bool first = l < shell.leaf_key.size;
  if (first) {
    const Voxel at = leaf_of_key(shell.leaf_key[l]);
    const uint32_t b =
        shell.block_table[(int64_t(at.x >> 4) * shell.block_dims[1] + (at.y >> 4)) * shell.block_dims[2] + (at.z >> 4)];
    for (int x = at.x & 15 & -leaves; x < (at.x & 15); ++x) {
      const int bit = x << 8 | (at.y & 15) << 4 | (at.z & 15);
      if (shell.blocks[b].word[bit >> 6] >> (bit & 63) & 1) first = false;
    }
  }
  const uint32_t lanes = __ballot_sync(kWholeWarp, first);
  uint32_t at = 0;
  if ((threadIdx.x & 31) == 0 && lanes) at = atomicAdd(count, uint32_t(__popc(lanes)));
  at = __shfl_sync(kWholeWarp, at, 0);
  if (first) rows[at + uint32_t(lanes_before(lanes))] = uint32_t(l);
}

/// Eight lanes a leaf of sites.
__global__ void number_words(VoxelSetView sites, closest::SiteWord* words) {
  const int64_t i = cuda_steps::thread_number(), leaf = i >> 3;
  const bool some = leaf < sites.leaf_key.size;
  const uint64_t bits = some ? sites.mask[leaf].word[i & 7] : 0;
  const int voxels = __popcll(bits);
  const int before = warp_sum_before<8>(voxels);
  if (some) words[i] = {bits, uint32_t(sites.first[leaf]) + uint32_t(before)};
}

/// Longer rows compute less twice, shorter ones keep all processors busy.
int32_t row_leaves(int64_t leaves) { return leaves < 40000 ? 2 : leaves < 150000 ? 4 : 8; }

template <int kReach, int kBand, class Keys>
closest::Transform transform(CudaExecutor& exec) {
  return transform_of(exec, closest::closest_sites<kReach, kBand, Keys>, closest::kWarps<kReach, kBand, Keys>,
                      closest::shared_bytes<kReach, kBand, Keys>());
}

template <int kBand>
closest::Transform transform_to_sites(CudaExecutor& exec, int32_t band_vox) {
  if constexpr (kBand <= closest::SmallPair::kMaxBand) {
    if (band_vox == kBand) return transform<1, kBand, closest::SmallPair>(exec);
    return transform_to_sites<kBand + 1>(exec, band_vox);
  } else {
    static_assert(reach_leaves(kBand) == 2 && reach_leaves(kMaxBandVox) == 3, "five or seven leaves across");
    return reach_leaves(band_vox) == 2 ? transform<2, 0, closest::LargePair>(exec)
                                       : transform<3, 0, closest::LargePair>(exec);
  }
}

/// The shell's leaves and their index, with room for masks and first.
VoxelSet find_shell_leaves(CudaExecutor& exec, const VoxelSetView& sites, int32_t band_vox) {
  LeafMarks marks(exec, sites.block_dims);
  const auto kernel = band_vox <= 8 ? mark_reached<1> : band_vox <= 16 ? mark_reached<2> : mark_reached<3>;
  const unsigned blocks = exec.device().resident_blocks(blocks_for(sites.leaf_key.size * 32, kMarkThreads), 8);
  kernel<<<blocks, kMarkThreads, 0, exec.stream()>>>(sites, band_vox, marks.marks());
  exec.check("mark shell leaves");
  VoxelSet set = marks.list(exec);
  set.mask = exec.make<LeafMask>(set.leaf_count());
  set.first = exec.make<int64_t>(set.leaf_count() + 1);
  require_success(cudaMemsetAsync(set.first.data() + set.leaf_count(), 0, sizeof(int64_t), exec.stream()), "clear");
  return set;
}

/// The rows of the shell, and counters: of them, and of those taken by a transform, two of which may run.
struct RowList {
  Buffer<uint32_t> first_leaf, counters;
  int32_t leaves;

  RowList(CudaExecutor& exec, const VoxelSetView& shell)
      : first_leaf(exec.make<uint32_t>(shell.leaf_key.size)),
        counters(exec.make<uint32_t>(3)),
        leaves(row_leaves(shell.leaf_key.size)) {
    require_success(cudaMemsetAsync(counters.data(), 0, size_t(counters.size_bytes()), exec.stream()), "clear");
    list_rows<<<cuda_steps::blocks_for(first_leaf.size()), cuda_steps::kThreads, 0, exec.stream()>>>(
        shell, leaves, first_leaf.view(), counters.data());
    exec.check("list rows");
  }
  closest::Rows rows(int transform) {
    return {first_leaf.view(), counters.data(), counters.data() + 1 + transform, leaves};
  }
};

Buffer<closest::SiteWord> words_of(CudaExecutor& exec, const VoxelSetView& sites) {
  Buffer<closest::SiteWord> words = exec.make<closest::SiteWord>(sites.leaf_key.size * 8);
  number_words<<<cuda_steps::blocks_for(words.size()), cuda_steps::kThreads, 0, exec.stream()>>>(sites, words.data());
  exec.check("number site words");
  return words;
}

/// Masks of the set's leaves, and before each of them the voxels of those before it.
void find_masks(CudaExecutor& exec, RowList& list, const closest::Input& in, VoxelSet& set) {
  find_shell_masks(exec, {list.rows(0), in, {set.mask.data(), set.first.data(), nullptr, nullptr}});
  exclusive_scan_async(exec.device(), set.first.view());
}

void fill_shell(CudaExecutor& exec, const VoxelSetView& sites, Shell& shell) {
  VoxelSet& set = shell.voxels;
  RowList list(exec, set.view());
  const Buffer<closest::SiteWord> words = words_of(exec, sites);
  const closest::Input in = {sites, set.view(), words.data(), shell.band_vox};
  find_masks(exec, list, in, set);
  const closest::Transform to_sites = transform_to_sites<1>(exec, shell.band_vox);  // while the device is busy
  set.active = exec.value(View<const int64_t>(set.first.view()), set.leaf_count());
  shell.closest_site = exec.make<uint32_t>(set.active);
  shell.distance_sq_vox = exec.make<uint16_t>(set.active);
  to_sites.run(exec, {list.rows(1), in, {nullptr, nullptr, shell.closest_site.data(), shell.distance_sq_vox.data()}},
               "closest sites");
}

}  // namespace

Shell CudaBackend::build_shell(const SiteSet& site_set, const ShellOptions& options, Context& context) const {
  CudaExecutor exec(context, "shell");
  const OnDevice<SiteSet> sites_here(exec, site_set);
  const VoxelSetView sites = sites_here->voxels.view();
  Shell shell;
  shell.band_vox = options.band_vox;
  shell.voxels = find_shell_leaves(exec, sites, options.band_vox);
  if (shell.voxels.leaf_count() > 0) fill_shell(exec, sites, shell);
  return shell;
}

VoxelSet CudaDilate::run(CudaExecutor& exec, const SiteSet& sites, int32_t radius_vox) {
  const VoxelSetView from = sites.voxels.view();
  VoxelSet set = find_shell_leaves(exec, from, radius_vox);
  if (set.leaf_count() == 0) return set;
  RowList list(exec, set.view());
  find_masks(exec, list, {from, set.view(), nullptr, radius_vox}, set);
  set.active = exec.value(View<const int64_t>(set.first.view()), set.leaf_count());
  return set;
}

}  // namespace isoshell
