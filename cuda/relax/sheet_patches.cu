// Makes SheetPatches: one warp a patch, its foreign vertices gathered in a hash table.
#include "cuda/relax/seed_buckets.cuh"
#include "cuda/relax/sheet_patches.cuh"
#include "cuda/runtime/warp.cuh"

namespace isoshell::cuda_relax {
namespace {

constexpr int kWarps = 2;
constexpr int kHashSlots = 2048;

struct PatchSource {
  VertexBlocksView blocks;
  View<const PointQ8> position;
  View<const Normal8> normal;
  View<const TriangleIndices> triangles;
  View<const int64_t> vertex_first;
  View<const uint32_t> vertex_triangles;
  EdgeLengthsView lengths;
  const int64_t* patch_first;  ///< of each block, and in the end how many there are
  int64_t patches;

  /// Vertices of a patch.
  struct Part {
    int64_t block, begin, end;
  };
  __device__ Part part(int64_t patch) const {
    int64_t lo = 0, hi = blocks.centre.size;
    while (hi - lo > 1) {
      const int64_t middle = (lo + hi) / 2;
      (patch_first[middle] <= patch ? lo : hi) = middle;
    }
    const int64_t number = patch - patch_first[lo], parts = patch_first[lo + 1] - patch_first[lo];
    const int64_t begin = blocks.first[lo], count = blocks.first[lo + 1] - begin;
    return {lo, begin + count * number / parts, begin + count * (number + 1) / parts};
  }

  /// Calls each(triangle) for those of the patch: their smallest vertex is one of its own. One lane a vertex.
  template <class Each>
  __device__ void for_each_triangle(const Part& part, int lane, Each each) const {
    for (int64_t v = part.begin + lane; v < part.end; v += 32) for_each_triangle_of(v, each);
  }
  template <class Each>
  __device__ void for_each_triangle_of(int64_t v, Each each) const {
    for (int64_t n = vertex_first[v]; n < vertex_first[v + 1]; ++n) {
      const TriangleIndices t = triangles[vertex_triangles[n]];
      if (t.a >= v && t.b >= v && t.c >= v) each(t);
    }
  }
};

/// Vertices of a patch beyond its own, each once. Too many leave `taken` above the limit.
struct ForeignVertices {
  uint32_t vertex[kHashSlots];
  uint16_t place[kHashSlots];
  int taken, triangles;

  __device__ void clear(int lane) {
    for (int i = lane; i < kHashSlots; i += 32) vertex[i] = kNone;
    if (lane == 0) taken = triangles = 0;
    __syncwarp();
  }
  __device__ static uint32_t slot_of(uint32_t v) { return (v * 2654435761u) >> 21; }
  __device__ void insert(uint32_t v) {
    for (uint32_t slot = slot_of(v);; slot = (slot + 1) & (kHashSlots - 1)) {
      const uint32_t seen = atomicCAS(&vertex[slot], kNone, v);
      if (seen == v) return;
      if (seen == kNone) {
        atomicAdd(&taken, 1);
        return;
      }
      if (*static_cast<volatile int*>(&taken) >= kMaxPatchVertices) return;
    }
  }
  __device__ int place_of(uint32_t v) const {
    uint32_t slot = slot_of(v);
    while (vertex[slot] != v) slot = (slot + 1) & (kHashSlots - 1);
    return place[slot];
  }
  __device__ void insert_corners(TriangleIndices t, int64_t own_end) {
    if (t.a >= own_end) insert(t.a);
    if (t.b >= own_end) insert(t.b);
    if (t.c >= own_end) insert(t.c);
    atomicAdd(&triangles, 1);
  }
};

struct CountParts {
  View<const int64_t> first;
  View<int64_t> parts;
  int max_own;
  __device__ void operator()(int64_t block) const {
    const int64_t own = block + 1 < first.size ? first[block + 1] - first[block] : 0;
    parts[block] = (own + max_own - 1) / max_own;
  }
};

/// What the patches have of each kind: per patch, then where each begins.
struct PatchCounts {
  int64_t *vertices, *triangles, *owned;
};

/// Where a patch's vertices and triangles begin, so that they, and a byte for each vertex, can be copied in steps of 16
/// bytes.
constexpr int kPlacesAtOnce = 16;
__device__ inline int64_t round_up(int64_t count) {
  return (count + kPlacesAtOnce - 1) / kPlacesAtOnce * kPlacesAtOnce;
}

__global__ void count_patches(PatchSource source, PatchCounts counts, int* misfits) {
  __shared__ ForeignVertices all[kWarps];
  const int lane = threadIdx.x & 31;
  const int64_t number = int64_t(blockIdx.x) * kWarps + (threadIdx.x >> 5);
  if (number >= source.patches) return;
  ForeignVertices& foreign = all[threadIdx.x >> 5];
  foreign.clear(lane);
  const PatchSource::Part part = source.part(number);
  const int64_t own_end = part.end;
  source.for_each_triangle(part, lane, [&](TriangleIndices t) { foreign.insert_corners(t, own_end); });
  __syncwarp();
  if (lane) return;
  const int64_t count = part.end - part.begin + foreign.taken;
  counts.vertices[number] = round_up(count);
  counts.triangles[number] = round_up(foreign.triangles);
  counts.owned[number] = (part.end - part.begin + 31) / 32 * 32;
  if (count > kMaxPatchVertices || foreign.triangles > kMaxPatchTriangles) atomicAdd(misfits, 1);
}

struct PatchTarget {
  PatchCounts first;
  Patch* patch;
  PatchVertex* vertex;
  uint32_t* normal;
  PackedTriangle* triangle;
  PieceBytes* owned;
  int* misfits;
};

__global__ void fill_patches(PatchSource source, PatchTarget to) {
  __shared__ ForeignVertices all[kWarps];
  __shared__ PieceExchange exchange[kWarps];
  const int lane = threadIdx.x & 31;
  const int64_t number = int64_t(blockIdx.x) * kWarps + (threadIdx.x >> 5);
  if (number >= source.patches) return;
  ForeignVertices& foreign = all[threadIdx.x >> 5];
  const PatchSource::Part part = source.part(number);
  const int64_t own = part.begin, own_end = part.end;
  foreign.clear(lane);
  source.for_each_triangle(part, lane, [&](TriangleIndices t) { foreign.insert_corners(t, own_end); });
  __syncwarp();

  const PointQ8 origin = source.blocks.centre[part.block];
  const int64_t first = to.first.vertices[number];
  label::Bounds bounds = label::empty_bounds();
  bool fits = true;
  const auto put = [&](int place, uint32_t v) {
    const PointQ8 p = source.position[v];
    const Normal8 n = source.normal[v];
    const Local u = local(p, origin);
    fits &= u.x > -kMaxLocal && u.x < kMaxLocal && u.y > -kMaxLocal && u.y < kMaxLocal && u.z > -kMaxLocal &&
            u.z < kMaxLocal;
    to.vertex[first + place] = {int16_t(u.x), int16_t(u.y), int16_t(u.z), 0};
    to.normal[first + place] = pack(n);
    label::include(bounds, p, n);
  };
  for (int64_t v = own + lane; v < own_end; v += 32) put(int(v - own), uint32_t(v));
  int places = int(own_end - own);
  for (int base = 0; base < kHashSlots; base += 32) {
    const uint32_t v = foreign.vertex[base + lane];
    const unsigned used = __ballot_sync(~0u, v != kNone);
    const int place = places + lanes_before(used);
    if (v != kNone) {
      foreign.place[base + lane] = uint16_t(place);
      put(place, v);
    }
    places += __popc(used);
  }
  if (lane == 0) foreign.triangles = 0;
  __syncwarp();

  PieceSum total{0, 0, 0, 0, 0};
  const int64_t triangle_first = to.first.triangles[number], owned_first = to.first.owned[number];
  for (int64_t base = own; base < own_end; base += 32) {
    PieceSum owned{0, 0, 0, 0, 0};
    const int64_t v = base + lane;
    if (v < own_end)
      source.for_each_triangle_of(v, [&](TriangleIndices t) {
        const PointQ8 a = source.position[t.a], b = source.position[t.b], c = source.position[t.c];
        const Vec64 n = cross(difference(b, a), difference(c, a));
        const uint32_t area2 = source.lengths.mass(uint32_t(isqrt(uint64_t(dot(n, n)))), t);
        const auto place = [&](uint32_t u) { return uint32_t(u < own_end ? int(u - own) : foreign.place_of(u)); };
        const uint32_t owner = t.a == v ? 0 : t.b == v ? 1 : 2;
        to.triangle[triangle_first + atomicAdd(&foreign.triangles, 1)] = {
            place(t.a) | place(t.b) << 10 | place(t.c) << 20 | owner << 30, area2};
        owned = owned + piece_sum(area2, local(a, origin), local(b, origin), local(c, origin));
      });
    total = total + owned;
    __syncwarp();
    to.owned[owned_first + base - own + lane] = bytes_of(owned, exchange[threadIdx.x >> 5]);
  }
  __syncwarp();
  Patch patch;
  patch.vertex_first = first;
  patch.triangle_first = triangle_first;
  patch.owned_first = owned_first;
  patch.total = {warp_sum(total.mass), warp_sum(total.first_x), warp_sum(total.first_y), warp_sum(total.first_z),
                 warp_sum(total.second)};
  const auto lowest = [](int32_t lo, int32_t from) { return int16_t(warp_min(lo) - from); };
  const auto highest = [](int32_t hi, int32_t from) { return int16_t(warp_max(hi) - from); };
  const Normal8 lo = bounds.normal_lo, hi = bounds.normal_hi;
  patch.bounds = {origin,
                  pack({int8_t(warp_min(lo.x)), int8_t(warp_min(lo.y)), int8_t(warp_min(lo.z))}),
                  {lowest(bounds.lo.x, origin.x), lowest(bounds.lo.y, origin.y), lowest(bounds.lo.z, origin.z)},
                  {highest(bounds.hi.x, origin.x), highest(bounds.hi.y, origin.y), highest(bounds.hi.z, origin.z)},
                  pack({int8_t(warp_max(hi.x)), int8_t(warp_max(hi.y)), int8_t(warp_max(hi.z))})};
  patch.own = uint16_t(own_end - own);
  patch.vertices = uint16_t(places);
  patch.triangles = uint16_t(foreign.triangles);
  patch.unused = 0;
  if (lane < round_up(patch.vertices) - patch.vertices) to.vertex[first + patch.vertices + lane] = {0, 0, 0, 0};
  if (lane < round_up(patch.triangles) - patch.triangles) to.triangle[triangle_first + patch.triangles + lane] = {0, 0};
  fits &= patch.total.mass < kMaxPatchMass;
  if (!fits) atomicAdd(to.misfits, 1);
  if (lane == 0) to.patch[number] = patch;
}

}  // namespace

SheetPatches make_sheet_patches(CudaExecutor& exec, const SurfaceMesh& surface, int max_own) {
  const Buffer<int64_t>& block_first = surface.blocks.first;
  Buffer<int64_t> patch_first = exec.make<int64_t>(block_first.size());
  exec.for_each("count patches of blocks", block_first.size(),
                CountParts{block_first.view(), patch_first.view(), max_own});
  const int64_t count = exec.exclusive_scan(patch_first.view());
  const PatchSource source{surface.blocks.view(),    surface.position.view(),     surface.normal.view(),
                           surface.triangles.view(), surface.vertex_first.view(), surface.vertex_triangles.view(),
                           lengths_of(surface),      patch_first.data(),          count};
  const unsigned blocks = unsigned((count + kWarps - 1) / kWarps);
  SheetPatches out;
  Buffer<int64_t> vertices = exec.make<int64_t>(count + 1), triangles = exec.make<int64_t>(count + 1),
                  owned = exec.make<int64_t>(count + 1);
  Buffer<int> misfits = exec.make<int>(1);
  for (Buffer<int64_t>* counts : {&vertices, &triangles, &owned}) exec.fill(counts->view(), int64_t(0));
  exec.fill(misfits.view(), 0);
  const PatchCounts counts{vertices.data(), triangles.data(), owned.data()};
  count_patches<<<blocks, kWarps * 32, 0, exec.stream()>>>(source, counts, misfits.data());
  exec.check("count patches");
  const int64_t copies = exec.exclusive_scan(vertices.view());
  const int64_t triangle_places = exec.exclusive_scan(triangles.view());
  const int64_t owned_slots = exec.exclusive_scan(owned.view());
  out.fits = exec.value(View<const int>(misfits.view()), 0) == 0;
  if (!out.fits) return out;
  out.patch = exec.make<Patch>(count);
  out.vertex = exec.make<PatchVertex>(copies);
  out.normal = exec.make<uint32_t>(copies);
  out.triangle = exec.make<PackedTriangle>(triangle_places);
  out.owned = exec.make<PieceBytes>(owned_slots);
  fill_patches<<<blocks, kWarps * 32, 0, exec.stream()>>>(
      source, {counts, out.patch.data(), out.vertex.data(), out.normal.data(), out.triangle.data(), out.owned.data(),
               misfits.data()});
  exec.check("fill patches");
  out.fits = exec.value(View<const int>(misfits.view()), 0) == 0;
  return out;
}

}  // namespace isoshell::cuda_relax
