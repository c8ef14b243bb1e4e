// CUDA's build_shell: leaves within reach of the sites, their masks, and with the counts in hand their values, which go
// straight to their places. Masks come from growing bitmaps where the band is small, else from the distance transform
// itself without its sites.
#include "cuda/closest_kernel.cuh"
#include "cuda/cuda_backend.h"
#include "cuda/executor_cuda.cuh"
#include "cuda/leaf_marks.cuh"
#include "cuda/reach_kernel.cuh"
#include "voxel/closest.h"

namespace isoshell {
namespace {

constexpr int kMarkThreads = 256;

/// Distance along one axis from place `at` of a leaf to the leaf `leaves` away.
__device__ int gap(int at, int leaves) { return leaves > 0 ? 8 * leaves - at : leaves < 0 ? at - 8 * leaves - 7 : 0; }

/// Marks every leaf that has a voxel within the band of a site: exactly the leaves of the shell. A warp a leaf of
/// sites, a lane a neighbour; the table says which voxels of a leaf are close enough to which neighbour.
template <int kReach>
__global__ void __launch_bounds__(kMarkThreads) mark_reached(VoxelSetView sites, int band, leaf_marks::Marks marks) {
  constexpr int kSpan = 2 * kReach + 1, kNeighbours = kSpan * kSpan * kSpan;
  __shared__ uint64_t table[8][kNeighbours];
  for (int i = int(threadIdx.x); i < 8 * kNeighbours; i += kMarkThreads) {
    const int n = i % kNeighbours, ly = n / kSpan % kSpan - kReach, lz = n % kSpan - kReach;
    const int gx = gap(i / kNeighbours, n / (kSpan * kSpan) - kReach);
    uint64_t near = 0;
    for (int y = 0; y < 8; ++y)
      for (int z = 0; z < 8; ++z) {
        const int gy = gap(y, ly), gz = gap(z, lz);
        near |= uint64_t(gx * gx + gy * gy + gz * gz <= band * band) << (8 * y + z);
      }
    table[i / kNeighbours][n] = near;
  }
  __syncthreads();
  const int lane = int(threadIdx.x & 31);
  const int64_t step = int64_t(gridDim.x) * (kMarkThreads / 32);
  for (int64_t l = cuda_steps::thread_number() >> 5; l < sites.leaf_key.size; l += step) {
    const Voxel at = leaf_of_key(sites.leaf_key[l]);
    uint64_t word[8];
    for (int x = 0; x < 8; ++x) word[x] = sites.mask[l].word[x];
    for (int n = lane; n < kNeighbours; n += 32) {
      uint64_t near = 0;
      for (int x = 0; x < 8; ++x) near |= word[x] & table[x][n];
      const int x = at.x + n / (kSpan * kSpan) - kReach, y = at.y + n / kSpan % kSpan - kReach,
                z = at.z + n % kSpan - kReach;
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
  const uint32_t lanes = __ballot_sync(closest::kAllLanes, first);
  uint32_t at = 0;
  if ((threadIdx.x & 31) == 0 && lanes) at = atomicAdd(count, uint32_t(__popc(lanes)));
  at = __shfl_sync(closest::kAllLanes, at, 0);
  if (first) rows[at + uint32_t(__popc(lanes & ((1u << (threadIdx.x & 31)) - 1)))] = uint32_t(l);
}

/// Eight lanes a leaf of sites.
__global__ void number_words(VoxelSetView sites, closest::SiteWord* words) {
  const int64_t i = cuda_steps::thread_number(), leaf = i >> 3;
  const bool some = leaf < sites.leaf_key.size;
  const uint64_t bits = some ? sites.mask[leaf].word[i & 7] : 0;
  const int voxels = __popcll(bits);
  int before = voxels;
  for (int offset = 1; offset < 8; offset <<= 1) {
    const int other = __shfl_up_sync(closest::kAllLanes, before, unsigned(offset), 8);
    if (int(i & 7) >= offset) before += other;
  }
  if (some) words[i] = {bits, uint32_t(sites.first[leaf]) + uint32_t(before - voxels)};
}

/// Longer rows compute less twice, shorter ones keep all processors busy.
int32_t row_leaves(int64_t leaves) { return leaves < 40000 ? 2 : leaves < 150000 ? 4 : 8; }

struct Arguments {
  closest::Rows rows;
  closest::Input in;
  closest::Output out;
};

/// A distance transform that fills the device.
struct Transform {
  void (*kernel)(closest::Rows, closest::Input, closest::Output);
  unsigned blocks, threads;
  int shared_bytes;

  void run(CudaExecutor& exec, const Arguments& a, const char* name) const {
    kernel<<<blocks, threads, size_t(shared_bytes), exec.stream()>>>(a.rows, a.in, a.out);
    exec.check(name);
  }
};

template <int kReach, int kBand, class Keys>
Transform transform(CudaExecutor& exec) {
  Transform t = {closest::closest_sites<kReach, kBand, Keys>, 0, closest::kWarps<Keys, kReach> * 32,
                 int(closest::shared_bytes<kReach, kBand, Keys>())};
  require_success(cudaFuncSetAttribute(t.kernel, cudaFuncAttributeMaxDynamicSharedMemorySize, t.shared_bytes),
                  "cudaFuncSetAttribute");
  int blocks = 0, processors = 0;
  require_success(
      cudaOccupancyMaxActiveBlocksPerMultiprocessor(&blocks, t.kernel, int(t.threads), size_t(t.shared_bytes)),
      "cudaOccupancyMaxActiveBlocksPerMultiprocessor");
  require_success(cudaDeviceGetAttribute(&processors, cudaDevAttrMultiProcessorCount, exec.device().device()),
                  "cudaDeviceGetAttribute");
  t.blocks = unsigned(blocks * processors);
  return t;
}

template <class Keys>
Transform wide_transform(CudaExecutor& exec, int32_t band_vox) {
  const int reach = reach_leaves(band_vox);
  return reach == 1   ? transform<1, 0, Keys>(exec)
         : reach == 2 ? transform<2, 0, Keys>(exec)
                      : transform<3, 0, Keys>(exec);
}

Transform transform_to_sites(CudaExecutor& exec, int32_t band_vox) {
  static_assert(closest::SmallPair::kMaxBand == 5, "one case each");
  switch (band_vox) {
    case 1:
      return transform<1, 1, closest::SmallPair>(exec);
    case 2:
      return transform<1, 2, closest::SmallPair>(exec);
    case 3:
      return transform<1, 3, closest::SmallPair>(exec);
    case 4:
      return transform<1, 4, closest::SmallPair>(exec);
    case 5:
      return transform<1, 5, closest::SmallPair>(exec);
    default:
      return wide_transform<closest::LargePair>(exec, band_vox);
  }
}

/// The paper's bands, unrolled, and all others.
Transform transform_to_masks(CudaExecutor& exec, int32_t band_vox) {
  if (band_vox == 6) return transform<1, 6, closest::DistancePair>(exec);
  if (band_vox == 9) return transform<2, 9, closest::DistancePair>(exec);
  return wide_transform<closest::DistancePair>(exec, band_vox);
}

template <int kBand>
void grow(CudaExecutor& exec, const Arguments& a) {
  const int64_t threads = a.in.shell.leaf_key.size * 16;
  reach::grow_sites<kBand>
      <<<unsigned((threads + reach::kThreads - 1) / reach::kThreads), reach::kThreads, 0, exec.stream()>>>(
          a.in.sites, a.in.shell, a.out.mask, a.out.count);
  exec.check("shell masks");
}

void find_masks(CudaExecutor& exec, const Arguments& a) {
  static_assert(reach::kMaxBand == 4, "one case each");
  switch (a.in.band_vox) {
    case 1:
      return grow<1>(exec, a);
    case 2:
      return grow<2>(exec, a);
    case 3:
      return grow<3>(exec, a);
    case 4:
      return grow<4>(exec, a);
    default:
      transform_to_masks(exec, a.in.band_vox).run(exec, a, "shell masks");
  }
}

/// The shell's leaves, and their index but for masks and first.
VoxelSet find_shell_leaves(CudaExecutor& exec, const VoxelSetView& sites, int32_t band_vox) {
  LeafMarks marks(exec, sites.block_dims);
  const int64_t most = 132 * 8, needed = (sites.leaf_key.size * 32 + kMarkThreads - 1) / kMarkThreads;
  const auto kernel = band_vox <= 8 ? mark_reached<1> : band_vox <= 16 ? mark_reached<2> : mark_reached<3>;
  if (needed > 0)
    kernel<<<unsigned(needed < most ? needed : most), kMarkThreads, 0, exec.stream()>>>(sites, band_vox, marks.marks());
  exec.check("mark shell leaves");
  return marks.list(exec);
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

void fill_shell(CudaExecutor& exec, const VoxelSetView& sites, Shell& shell) {
  VoxelSet& set = shell.voxels;
  RowList list(exec, set.view());
  const Buffer<closest::SiteWord> words = words_of(exec, sites);
  const closest::Input in = {sites, set.view(), words.data(), shell.band_vox};
  find_masks(exec, {list.rows(0), in, {set.mask.data(), set.first.data(), nullptr, nullptr}});
  exclusive_scan_async(exec.device(), set.first.view());
  const Transform to_sites = transform_to_sites(exec, shell.band_vox);  // while the device is busy
  set.active = exec.value(View<const int64_t>(set.first.view()), set.leaf_count());
  shell.closest_site = exec.make<uint32_t>(set.active);
  shell.distance_sq_vox = exec.make<uint16_t>(set.active);
  to_sites.run(exec, {list.rows(1), in, {nullptr, nullptr, shell.closest_site.data(), shell.distance_sq_vox.data()}},
               "closest sites");
}

}  // namespace

Shell cuda_build_shell(const SiteSet& site_set, const ShellOptions& options, Context& context) {
  CudaExecutor exec(context, "shell");
  const OnDevice<SiteSet> sites_here(exec, site_set);
  const VoxelSetView sites = sites_here->voxels.view();
  Shell shell;
  shell.band_vox = options.band_vox;
  VoxelSet& set = shell.voxels;
  set = find_shell_leaves(exec, sites, options.band_vox);
  set.mask = exec.make<LeafMask>(set.leaf_count());
  set.first = exec.make<int64_t>(set.leaf_count() + 1);
  require_success(cudaMemsetAsync(set.first.data() + set.leaf_count(), 0, sizeof(int64_t), exec.stream()), "clear");
  if (set.leaf_count() > 0) fill_shell(exec, sites, shell);
  return shell;
}

}  // namespace isoshell
