// CUDA's voxelize: leaves first, then their voxels, each by warps that share the leaves of 32 triangles evenly.
// Triangles too large for one window go through a list of windows.
#include "cuda/cuda_backend.h"
#include "cuda/runtime/executor_cuda.cuh"
#include "cuda/runtime/warp.cuh"
#include "cuda/sites/overlap_plan.h"
#include "cuda/sparse/leaf_marks.cuh"
#include "stages/sites/sites_body.h"

namespace isoshell {
namespace {

using overlap_plan::Plan;

constexpr int kWarps = 4;             ///< a thread block
constexpr int32_t kMostColumns = 64;  ///< of a triangle whose voxels are found column by column

/// Windows of large triangles. Made in any order; more than fit are counted, but not kept.
struct Windows {
  View<Tile> tiles;
  unsigned long long* count;

  __device__ int64_t size() const { return int64_t(*count) < tiles.size ? int64_t(*count) : tiles.size; }
};

__device__ int32_t width(const CellRange& r, int axis) { return r.hi[axis] - r.lo[axis] + 1; }
__device__ bool is_large(const CellRange& r) {
  constexpr int32_t kMost = overlap_plan::kSmallSpan + 1;
  return width(r, 0) > kMost || width(r, 1) > kMost || width(r, 2) > kMost;
}

__device__ CellRange leaf_range(const CellRange& r) {
  return {{r.lo[0] >> 3, r.lo[1] >> 3, r.lo[2] >> 3}, {r.hi[0] >> 3, r.hi[1] >> 3, r.hi[2] >> 3}};
}

/// Once a triangle, so kept out of the way.
__device__ __noinline__ void list_windows(const TriangleQ8& t, uint32_t triangle, const BlockGrid& grid,
                                          const Windows& windows) {
  for_each_cell<kMaxBlocksPerAxis>(t, grid.range(), kBlockShift, [&](Voxel block) {
    const unsigned long long at = atomicAdd(windows.count, 1ull);
    if (int64_t(at) < windows.tiles.size) windows.tiles[int64_t(at)] = {triangle, grid.number(block)};
  });
}

/// Whole triangles that fit a window.
struct SmallTriangles {
  static constexpr bool kWhole = true;
  SurfaceView surface;
  BlockGrid grid;
  Windows windows;
  __device__ int64_t size() const { return surface.triangles.size; }
  /// The plan of a triangle whose leaves have to be tested. Marks those of a row, which is met as a whole, and lists
  /// the windows of large triangles.
  __device__ bool plan_leaves(int64_t i, const leaf_marks::Marks& marks, Plan& plan) const {
    const TriangleQ8 t = surface.triangle(i);
    const CellRange range = bounding_range(t, kVoxelShift), leaves = leaf_range(range);
    if (is_large(range)) {
      list_windows(t, uint32_t(i), grid, windows);
      return false;
    }
    if (axis_of_row(leaves) < 0) {
      make_small_plan(t, range, plan);
      return true;
    }
    for (int32_t x = leaves.lo[0]; x <= leaves.hi[0]; ++x)
      for (int32_t y = leaves.lo[1]; y <= leaves.hi[1]; ++y)
        for (int32_t z = leaves.lo[2]; z <= leaves.hi[2]; ++z) marks.mark(x, y, z);
    return false;
  }
  __device__ bool plan_voxels(int64_t i, Plan& plan) const {
    const TriangleQ8 t = surface.triangle(i);
    const CellRange range = bounding_range(t, kVoxelShift);
    if (is_large(range)) return false;
    make_small_plan(t, range, plan);
    return true;
  }
};

/// Pieces of the others.
struct LargeTriangles {
  static constexpr bool kWhole = false;
  SurfaceView surface;
  BlockGrid grid;
  Windows windows;
  __device__ int64_t size() const { return windows.size(); }
  __device__ bool plan(int64_t i, Plan& plan) const {
    const Tile tile = windows.tiles[i];
    const TriangleQ8 t = surface.triangle(tile.triangle);
    const Voxel b = grid.block(tile.block);
    const CellRange window = {{b.x * 128, b.y * 128, b.z * 128}, {b.x * 128 + 127, b.y * 128 + 127, b.z * 128 + 127}};
    return make_plan(t, common_range(bounding_range(t, kVoxelShift), window), plan);
  }
  __device__ bool plan_leaves(int64_t i, const leaf_marks::Marks&, Plan& plan) const { return this->plan(i, plan); }
  __device__ bool plan_voxels(int64_t i, Plan& plan) const { return this->plan(i, plan); }
};

__device__ void mark_word(LeafMask& mask, int x, uint64_t word) {
  if (word) atomicOr(reinterpret_cast<unsigned long long*>(&mask.word[x]), (unsigned long long)word);
}

/// A leaf that the bounding range of one of the warp's triangles meets.
struct Candidate {
  int owner;         ///< lane of the triangle
  int32_t leaf[3];   ///< coordinates
  int32_t voxel[3];  ///< of its lowest voxel in the triangle's window; may be negative
};

/// The plans of one warp, and its candidates in any order.
struct PlanShare {
  Plan plan[32];
  int32_t end[32];  ///< candidates of this lane and those before

  __device__ static int32_t leaves(const Plan& p, int axis) {
    return ((p.base[axis] + p.last[axis]) >> 3) - (p.base[axis] >> 3) + 1;
  }
  /// Enters what this lane's plan offers to the warp; returns the sum.
  __device__ int32_t enter(int32_t count) {
    const int lane = int(threadIdx.x & 31);
    count = warp_sum_until(count);
    __syncwarp();
    end[lane] = count;
    __syncwarp();
    return __shfl_sync(kWholeWarp, count, 31);
  }
  __device__ int32_t leaves_of(int lane) const {
    return leaves(plan[lane], 0) * leaves(plan[lane], 1) * leaves(plan[lane], 2);
  }
  /// Lane of the plan that offers number i, which becomes its number there.
  __device__ int owner(int32_t& i) const {
    int lane = 0;
    for (int step = 16; step > 0; step >>= 1)
      if (end[lane + step - 1] <= i) lane += step;
    i -= lane ? end[lane - 1] : 0;
    return lane;
  }
  __device__ Candidate candidate(int32_t i) const {
    Candidate c = {owner(i), {}, {}};
    const Plan& p = plan[c.owner];
    const int32_t at = i, nz = leaves(p, 2), ny = leaves(p, 1);
    const int32_t xy = at / nz;
    c.leaf[0] = xy / ny + (p.base[0] >> 3);
    c.leaf[1] = xy % ny + (p.base[1] >> 3);
    c.leaf[2] = at - xy * nz + (p.base[2] >> 3);
    for (int axis = 0; axis < 3; ++axis) c.voxel[axis] = c.leaf[axis] * 8 - p.base[axis];
    return c;
  }
};

/// Elements of a warp at a time: a lane each, fewer where there are too few for all warps.
__device__ int elements_of_warp(int64_t size) {
  const int64_t warps = int64_t(gridDim.x) * kWarps, share = (size + warps - 1) / warps;
  return int(share < 32 ? share : 32);
}

template <class Source>
__global__ void __launch_bounds__(kWarps * 32, 8) mark_leaves(Source source, leaf_marks::Marks marks) {
  __shared__ PlanShare shares[kWarps];
  PlanShare& share = shares[threadIdx.x >> 5];
  const int lane = int(threadIdx.x & 31);
  const int64_t size = source.size(), warps = int64_t(gridDim.x) * kWarps;
  const int elements = elements_of_warp(size);
  for (int64_t first = (cuda_steps::thread_number() >> 5) * elements; first < size; first += warps * elements) {
    const bool some =
        lane < elements && first + lane < size && source.plan_leaves(first + lane, marks, share.plan[lane]);
    const int32_t candidates = share.enter(some ? share.leaves_of(lane) : 0);
    for (int32_t i = lane; i < candidates; i += 32) {
      const Candidate c = share.candidate(i);
      if (meets_leaf(share.plan[c.owner], c.voxel[0], c.voxel[1], c.voxel[2]))
        marks.mark(c.leaf[0], c.leaf[1], c.leaf[2]);
    }
    __syncwarp();
  }
}

/// Small triangles go column by column, larger ones, which fill leaves better, leaf by leaf. Only for plans of whole
/// triangles: where a window cuts one, its values need not fit the columns' 32 bits.
__device__ bool is_by_columns(const Plan& plan) {
  return is_tiny(plan) && (plan.last[0] + 1) * (plan.last[1] + 1) <= kMostColumns;
}

/// The voxels of a tiny triangle in one of its columns along z.
__device__ void mark_column(const Plan& plan, int32_t column, const VoxelSetView& set, LeafMask* masks) {
  const int32_t width = plan.last[1] + 1, x = column / width, y = column - x * width;
  uint32_t bits = column_bits(plan, x, y) << (plan.base[2] & 7);
  const int32_t at_x = plan.base[0] + x, at_y = plan.base[1] + y;
  for (int32_t leaf_z = plan.base[2] >> 3; bits; ++leaf_z, bits >>= 8) {
    const uint32_t row = bits & 255;
    if (!row) continue;
    auto* words = reinterpret_cast<uint32_t*>(masks[find_leaf(set, {at_x >> 3, at_y >> 3, leaf_z})].word);
    atomicOr(words + (2 * (at_x & 7) + (at_y >> 2 & 1)), row << (8 * (at_y & 3)));
  }
}

/// A triangle in a leaf.
struct Meeting {
  uint32_t leaf;
  int32_t owner;
  int32_t voxel[3];
};

/// Voxels of a word, in these rows, that the plane meets; plane values at its first.
template <class Int>
__device__ uint64_t cut_by_plane(uint64_t word, uint32_t rows, Int low, Int high, Int step_y, Int step_z) {
  uint64_t met = 0;
  for (int y = 0; y < 8; ++y, low += step_y, high += step_y) {
    const uint32_t row = uint32_t(word >> (8 * y)) & 255;
    if ((rows >> y & 1) && row) met |= uint64_t(row & overlap_plan::plane_column(low, high, step_z)) << (8 * y);
  }
  return met;
}

/// The voxels of a leaf that meet the triangle, by eight lanes: a lane returns the word of its x.
__device__ uint64_t voxels_of(const Plan& plan, const int32_t at[3]) {
  const int lane = int(threadIdx.x & 7);
  const int32_t x = at[0] + lane;
  const uint32_t ys = overlap_plan::range_bits(-at[1], plan.last[1] - at[1]);
  const uint32_t zs = overlap_plan::range_bits(-at[2], plan.last[2] - at[2]);
  uint64_t yz = 0;
  if (ys >> lane & 1) yz = uint64_t(overlap_plan::shadow_row(plan.side[2], at[1] + lane, at[2]) & zs) << (8 * lane);
  yz = warp_or<8>(yz);
  uint32_t rows = 0;
  if (x >= 0 && x <= plan.last[0]) rows = overlap_plan::shadow_row(plan.side[0], x, at[1]) & ys;
  uint64_t word = yz;
  if (rows) {
    const uint64_t xz = overlap_plan::shadow_row(plan.side[1], x, at[2]);
    word &= xz * 0x0101010101010101ull;
  }
  const overlap_plan::PlaneValues plane = overlap_plan::plane_at(plan, x, at[1], at[2]);
  const int64_t ny = overlap_plan::joined(plan.normal[1]), nz = overlap_plan::joined(plan.normal[2]);
  if (plan.narrow) return cut_by_plane(word, rows, int32_t(plane.low), int32_t(plane.high), int32_t(ny), int32_t(nz));
  return cut_by_plane(word, rows, plane.low, plane.high, ny, nz);
}

template <class Source>
__global__ void __launch_bounds__(kWarps * 32) mark_voxels_of_leaves(Source source, VoxelSetView set, LeafMask* masks) {
  __shared__ PlanShare shares[kWarps];
  __shared__ Meeting queues[kWarps][32];
  PlanShare& share = shares[threadIdx.x >> 5];
  Meeting* queue = queues[threadIdx.x >> 5];
  const int lane = int(threadIdx.x & 31);
  const int64_t size = source.size(), warps = int64_t(gridDim.x) * kWarps;
  const int elements = elements_of_warp(size);
  for (int64_t first = (cuda_steps::thread_number() >> 5) * elements; first < size; first += warps * elements) {
    const bool some = lane < elements && first + lane < size && source.plan_voxels(first + lane, share.plan[lane]);
    const bool tiny = some && Source::kWhole && is_by_columns(share.plan[lane]);
    const int32_t columns = share.enter(tiny ? (share.plan[lane].last[0] + 1) * (share.plan[lane].last[1] + 1) : 0);
    for (int32_t i = lane; i < columns; i += 32) {
      int32_t column = i;
      const Plan& plan = share.plan[share.owner(column)];
      mark_column(plan, column, set, masks);
    }
    const int32_t candidates = share.enter(some && !tiny ? share.leaves_of(lane) : 0);
    for (int32_t start = 0; start < candidates; start += 32) {
      Candidate c = {};
      bool met = start + lane < candidates;
      if (met) {
        c = share.candidate(start + lane);
        met = meets_leaf(share.plan[c.owner], c.voxel[0], c.voxel[1], c.voxel[2]);
      }
      const uint32_t lanes = __ballot_sync(kWholeWarp, met);
      if (met)
        queue[lanes_before(lanes)] = {
            find_leaf(set, {c.leaf[0], c.leaf[1], c.leaf[2]}), c.owner, {c.voxel[0], c.voxel[1], c.voxel[2]}};
      __syncwarp();
      const int count = __popc(lanes);
      for (int i = lane >> 3; i < ((count + 3) & ~3); i += 4) {
        const Meeting m = queue[i < count ? i : 0];
        const uint64_t word = voxels_of(share.plan[m.owner], m.voxel);
        if (i < count) mark_word(masks[m.leaf], lane & 7, word);
      }
      __syncwarp();
    }
    __syncwarp();
  }
}

struct CountVoxels {
  const LeafMask* mask;
  int64_t* count;
  __device__ void operator()(int64_t leaf) const {
    int64_t voxels = 0;
    for (const uint64_t word : mask[leaf].word) voxels += popcount64(word);
    count[leaf] = voxels;
  }
};

SiteSet voxelize_on_device(CudaExecutor& exec, const LatticeSurface& surface) {
  const BlockGrid grid = block_grid(surface.frame);
  const SurfaceView view = view_of(surface);
  const int64_t triangles = view.triangles.size;
  const unsigned small_blocks = cuda_steps::blocks_for(triangles),
                 large_blocks = exec.device().resident_blocks(triangles, 4);
  static_assert(cuda_steps::kThreads == kWarps * 32, "blocks_for counts blocks of this size");
  SiteSet sites;
  VoxelSet& set = sites.voxels;
  Buffer<Tile> tiles;
  for (int64_t capacity = 1024 + triangles;;) {
    LeafMarks marks(exec, grid.dims);
    tiles = exec.make<Tile>(capacity);
    const Windows windows = {tiles.view(), marks.counter()};
    const SmallTriangles small = {view, grid, windows};
    const LargeTriangles large = {view, grid, windows};
    mark_leaves<<<small_blocks, kWarps * 32, 0, exec.stream()>>>(small, marks.marks());
    mark_leaves<<<large_blocks, kWarps * 32, 0, exec.stream()>>>(large, marks.marks());
    exec.check("mark leaves");
    set = marks.list(exec);
    if (marks.counted() > capacity) {  // rare: once more with room for all
      capacity = marks.counted();
      continue;
    }
    const int64_t leaves = set.leaf_count();
    set.mask = exec.make<LeafMask>(leaves);
    set.first = exec.make<int64_t>(leaves + 1);
    require_success(cudaMemsetAsync(set.mask.data(), 0, size_t(set.mask.size_bytes()), exec.stream()), "clear masks");
    mark_voxels_of_leaves<<<small_blocks, kWarps * 32, 0, exec.stream()>>>(small, set.view(), set.mask.data());
    if (marks.counted() > 0)
      mark_voxels_of_leaves<<<large_blocks, kWarps * 32, 0, exec.stream()>>>(large, set.view(), set.mask.data());
    exec.check("mark voxels");
    exec.for_each("count voxels", leaves, CountVoxels{set.mask.data(), set.first.data()});
    exclusive_scan_async(exec.device(), set.first.view());
    set.active = exec.value(View<const int64_t>(set.first.view()), leaves);
    return sites;
  }
}

}  // namespace

SiteSet CudaBackend::voxelize(const LatticeSurface& surface, Context& context) const {
  CudaExecutor exec(context, "sites");
  return voxelize_on_device(exec, *OnDevice<LatticeSurface>(exec, surface));
}

}  // namespace isoshell
