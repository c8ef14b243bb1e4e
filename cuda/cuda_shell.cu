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

struct Launch {
  CudaExecutor& exec;
  closest::Rows rows;
  closest::Input in;
  closest::Output out;
};

template <int kReach, int kBand, class Keys>
void launch(const Launch& l, const char* name) {
  const auto kernel = closest::closest_sites<kReach, kBand, Keys>;
  constexpr int64_t kBytes = closest::shared_bytes<kReach, kBand, Keys>();
  require_success(cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize, int(kBytes)),
                  "cudaFuncSetAttribute");
  int blocks = 0;
  require_success(
      cudaOccupancyMaxActiveBlocksPerMultiprocessor(&blocks, kernel, closest::kWarps<Keys, kReach> * 32, kBytes),
      "cudaOccupancyMaxActiveBlocksPerMultiprocessor");
  int processors = 0;
  require_success(cudaDeviceGetAttribute(&processors, cudaDevAttrMultiProcessorCount, l.exec.device().device()),
                  "cudaDeviceGetAttribute");
  kernel<<<unsigned(blocks * processors), closest::kWarps<Keys, kReach> * 32, kBytes, l.exec.stream()>>>(l.rows, l.in,
                                                                                                         l.out);
  l.exec.check(name);
}

template <class Keys>
void launch_wide(const Launch& l, const char* name) {
  const int reach = reach_leaves(l.in.band_vox);
  return reach == 1   ? launch<1, 0, Keys>(l, name)
         : reach == 2 ? launch<2, 0, Keys>(l, name)
                      : launch<3, 0, Keys>(l, name);
}

void find_values(const Launch& l) {
  static_assert(closest::SmallPair::kMaxBand == 5, "one case each");
  const char* name = "closest sites";
  switch (l.in.band_vox) {
    case 1:
      return launch<1, 1, closest::SmallPair>(l, name);
    case 2:
      return launch<1, 2, closest::SmallPair>(l, name);
    case 3:
      return launch<1, 3, closest::SmallPair>(l, name);
    case 4:
      return launch<1, 4, closest::SmallPair>(l, name);
    case 5:
      return launch<1, 5, closest::SmallPair>(l, name);
    default:
      return launch_wide<closest::LargePair>(l, name);
  }
}

template <int kBand>
void grow(const Launch& l) {
  const int64_t threads = l.in.shell.leaf_key.size * 16;
  reach::grow_sites<kBand>
      <<<unsigned((threads + reach::kThreads - 1) / reach::kThreads), reach::kThreads, 0, l.exec.stream()>>>(
          l.in.sites, l.in.shell, l.out.mask, l.out.count);
  l.exec.check("shell masks");
}

void find_masks(const Launch& l) {
  static_assert(reach::kMaxBand == 4, "one case each");
  switch (l.in.band_vox) {
    case 1:
      return grow<1>(l);
    case 2:
      return grow<2>(l);
    case 3:
      return grow<3>(l);
    case 4:
      return grow<4>(l);
    default:
      return launch_wide<closest::DistancePair>(l, "shell masks");
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

}  // namespace

Shell cuda_build_shell(const SiteSet& site_set, const ShellOptions& options, Context& context) {
  CudaExecutor exec(context, "shell");
  const OnDevice<SiteSet> sites_here(exec, site_set);
  const VoxelSetView sites = sites_here->voxels.view();
  Shell shell;
  shell.band_vox = options.band_vox;
  VoxelSet& set = shell.voxels;
  set = find_shell_leaves(exec, sites, options.band_vox);
  const int64_t leaves = set.leaf_count();
  set.mask = exec.make<LeafMask>(leaves);
  set.first = exec.make<int64_t>(leaves + 1);
  require_success(cudaMemsetAsync(set.first.data() + leaves, 0, sizeof(int64_t), exec.stream()), "clear");

  Buffer<uint32_t> rows = exec.make<uint32_t>(leaves), counters = exec.make<uint32_t>(3);
  require_success(cudaMemsetAsync(counters.data(), 0, size_t(counters.size_bytes()), exec.stream()), "clear");
  if (leaves > 0)
    list_rows<<<cuda_steps::blocks_for(leaves), cuda_steps::kThreads, 0, exec.stream()>>>(
        set.view(), row_leaves(leaves), rows.view(), counters.data());
  exec.check("list rows");
  const int64_t site_words = sites.leaf_key.size * 8;
  Buffer<closest::SiteWord> words = exec.make<closest::SiteWord>(site_words);
  if (site_words > 0)
    number_words<<<cuda_steps::blocks_for(site_words), cuda_steps::kThreads, 0, exec.stream()>>>(sites, words.data());
  exec.check("number site words");

  Launch l = {exec,
              {rows.view(), counters.data(), counters.data() + 1, row_leaves(leaves)},
              {sites, set.view(), words.data(), options.band_vox},
              {set.mask.data(), set.first.data(), nullptr, nullptr}};
  if (leaves > 0) find_masks(l);
  exclusive_scan_async(exec.device(), set.first.view());
  set.active = exec.value(View<const int64_t>(set.first.view()), leaves);
  shell.closest_site = exec.make<uint32_t>(set.active);
  shell.distance_sq_vox = exec.make<uint16_t>(set.active);
  l.rows.next = counters.data() + 2;
  l.out = {nullptr, nullptr, shell.closest_site.data(), shell.distance_sq_vox.data()};
  if (leaves > 0) find_values(l);
  return shell;
}

}  // namespace isoshell
