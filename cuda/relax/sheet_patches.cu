// Makes SheetPatches: one warp a patch, its foreign vertices gathered in a hash table.
#include <utility>

#include "cuda/relax/seed_buckets.cuh"
#include "cuda/relax/sheet_patches.cuh"
#include "cuda/runtime/warp.cuh"

namespace isoshell::cuda_relax {
namespace {

constexpr int kWarps = 2;
// Of the table of foreign vertices. Few patches need the large one; where none does, four times as many warps find
// room.
constexpr int kUsualSlots = 512, kMostSlots = 2048;

struct PatchSource {
  VertexBlocksView blocks;
  View<const PointQ8> position;
  View<const Normal8> normal;
  View<const TriangleIndices> triangles;
  View<const uint32_t> vertex_first;
  View<const uint32_t> vertex_triangles;
  EdgeLengthsView lengths;
  label::PatchesView surface_patches;
  View<const uint32_t> fixed;  ///< per vertex; empty without fixed seeds
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

/// Vertices of a patch beyond its own, each once. Too many leave `taken` at the limit or above.
template <int kSlots>
struct ForeignVertices {
  static constexpr int kLimit = kSlots / 2;
  static_assert(kMostSlots / 2 >= kMaxPatchVertices, "all vertices of a patch have room");
  uint32_t vertex[kSlots];
  uint16_t place[kSlots];
  int taken, triangles;

  __device__ void clear(int lane) {
    for (int i = lane; i < kSlots; i += 32) vertex[i] = kNone;
    if (lane == 0) taken = triangles = 0;
    __syncwarp();
  }
  __device__ static uint32_t slot_of(uint32_t v) { return ((v * 2654435761u) >> 16) * kSlots >> 16; }
  __device__ void insert(uint32_t v) {
    for (uint32_t slot = slot_of(v);; slot = (slot + 1) & (kSlots - 1)) {
      const uint32_t seen = atomicCAS(&vertex[slot], kNone, v);
      if (seen == v) return;
      if (seen == kNone) {
        atomicAdd(&taken, 1);
        return;
      }
      if (*static_cast<volatile int*>(&taken) >= kLimit) return;
    }
  }
  __device__ int place_of(uint32_t v) const {
    uint32_t slot = slot_of(v);
    while (vertex[slot] != v) slot = (slot + 1) & (kSlots - 1);
    return place[slot];
  }
  __device__ void insert_corners(TriangleIndices t, int64_t own_end) {
    if (t.a >= own_end) insert(t.a);
    if (t.b >= own_end) insert(t.b);
    if (t.c >= own_end) insert(t.c);
    atomicAdd(&triangles, 1);
  }

  /// Those of a patch, and how many triangles it has. By one warp.
  __device__ void gather(const PatchSource& source, const PatchSource::Part& part, int lane) {
    clear(lane);
    const int64_t own_end = part.end;
    source.for_each_triangle(part, lane, [&](TriangleIndices t) { insert_corners(t, own_end); });
    __syncwarp();
  }
};

/// How many patches the vertices of a block make.
struct PatchesOfBlock {
  View<const int64_t> first;
  int max_own;
  __device__ int64_t operator()(int64_t block) const {
    return (first[block + 1] - first[block] + max_own - 1) / max_own;
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

template <int kSlots>
__global__ void count_patches(PatchSource source, PatchCounts counts, int* misfits) {
  __shared__ ForeignVertices<kSlots> all[kWarps];
  const int lane = threadIdx.x & 31;
  const int64_t number = int64_t(blockIdx.x) * kWarps + (threadIdx.x >> 5);
  if (number >= source.patches) return;
  ForeignVertices<kSlots>& foreign = all[threadIdx.x >> 5];
  const PatchSource::Part part = source.part(number);
  foreign.gather(source, part, lane);
  if (lane) return;
  const int64_t count = part.end - part.begin + foreign.taken;
  counts.vertices[number] = round_up(count);
  counts.triangles[number] = round_up(foreign.triangles);
  counts.owned[number] = (part.end - part.begin + 31) / 32 * 32;
  const bool fits = foreign.taken < foreign.kLimit && count <= kMaxPatchVertices;
  if (!fits || foreign.triangles > kMaxPatchTriangles) atomicAdd(misfits, 1);
}

struct PatchTarget {
  PatchCounts first;
  Patch* patch;
  PatchVertex* vertex;
  uint32_t* normal;
  PackedTriangle* triangle;
  PieceBytes* owned;
  uint32_t* fixed;
  int* misfits;
};

/// Fills one patch, by one warp.
template <int kSlots>
class FillPatch {
 public:
  __device__ FillPatch(const PatchSource& source, const PatchTarget& to, int64_t number,
                       ForeignVertices<kSlots>& foreign, PieceExchange& exchange)
      : source_(source),
        to_(to),
        number_(number),
        foreign_(foreign),
        exchange_(exchange),
        lane_(threadIdx.x & 31),
        part_(source.part(number)),
        origin_(source.blocks.centre[part_.block]),
        vertex_first_(to.first.vertices[number]),
        triangle_first_(to.first.triangles[number]),
        owned_first_(to.first.owned[number]) {}

  __device__ void run() {
    foreign_.gather(source_, part_, lane_);
    copy_own_vertices();
    copy_foreign_vertices();
    pack_triangles();
    describe();
  }

 private:
  __device__ void copy_vertex(int place, uint32_t v) {
    const PointQ8 p = source_.position[v];
    const Normal8 n = source_.normal[v];
    const Local u = local(p, origin_);
    fits_ &= u.x > -kMaxLocal && u.x < kMaxLocal && u.y > -kMaxLocal && u.y < kMaxLocal && u.z > -kMaxLocal &&
             u.z < kMaxLocal;
    to_.vertex[vertex_first_ + place] = {int16_t(u.x), int16_t(u.y), int16_t(u.z), 0};
    to_.normal[vertex_first_ + place] = pack(n);
    label::include(bounds_, p, n);
    if (source_.fixed.empty()) return;
    to_.fixed[vertex_first_ + place] = source_.fixed[v];
    has_fixed_ |= source_.fixed[v] != kNone;
  }

  __device__ void copy_own_vertices() {
    for (int64_t v = part_.begin + lane_; v < part_.end; v += 32) copy_vertex(int(v - part_.begin), uint32_t(v));
    places_ = int(part_.end - part_.begin);
  }

  /// In the order of the hash table, which keeps their places for the triangles.
  __device__ void copy_foreign_vertices() {
    for (int base = 0; base < kSlots; base += 32) {
      const uint32_t v = foreign_.vertex[base + lane_];
      const unsigned used = __ballot_sync(~0u, v != kNone);
      const int place = places_ + lanes_before(used);
      if (v != kNone) {
        foreign_.place[base + lane_] = uint16_t(place);
        copy_vertex(place, v);
      }
      places_ += __popc(used);
    }
    if (lane_ == 0) foreign_.triangles = 0;
    __syncwarp();
  }

  /// The triangles, and the moments of those that each vertex owns; in `total_` those of the lane's vertices.
  __device__ void pack_triangles() {
    for (int64_t base = part_.begin; base < part_.end; base += 32) {
      PieceSum owned{0, 0, 0, 0, 0};
      const int64_t v = base + lane_;
      if (v < part_.end)
        source_.for_each_triangle_of(v, [&](TriangleIndices t) { owned = owned + pack_triangle(t, v); });
      total_ = total_ + owned;
      __syncwarp();
      to_.owned[owned_first_ + base - part_.begin + lane_] = bytes_of(owned, exchange_);
    }
    __syncwarp();
  }

  /// A triangle of vertex v. Returns its moments.
  __device__ PieceSum pack_triangle(TriangleIndices t, int64_t v) {
    const PointQ8 a = source_.position[t.a], b = source_.position[t.b], c = source_.position[t.c];
    const Vec64 n = cross(difference(b, a), difference(c, a));
    const uint32_t area2 = source_.lengths.mass(uint32_t(isqrt(uint64_t(dot(n, n)))), t);
    const uint32_t owner = t.a == v ? 0 : t.b == v ? 1 : 2;
    to_.triangle[triangle_first_ + atomicAdd(&foreign_.triangles, 1)] = {
        place_of(t.a) | place_of(t.b) << 10 | place_of(t.c) << 20 | owner << 30, area2};
    return piece_sum(area2, local(a, origin_), local(b, origin_), local(c, origin_));
  }
  __device__ uint32_t place_of(uint32_t v) const {
    return uint32_t(v < part_.end ? int(v - part_.begin) : foreign_.place_of(v));
  }

  __device__ void describe() {
    Patch patch;
    patch.vertex_first = vertex_first_;
    patch.triangle_first = triangle_first_;
    patch.owned_first = owned_first_;
    patch.total = {warp_sum(total_.mass), warp_sum(total_.first_x), warp_sum(total_.first_y), warp_sum(total_.first_z),
                   warp_sum(total_.second)};
    patch.bounds = bounds_of_warp();
    patch.own = uint16_t(part_.end - part_.begin);
    patch.vertices = uint16_t(places_);
    patch.triangles = uint16_t(foreign_.triangles);
    patch.has_fixed = __any_sync(~0u, has_fixed_) ? 1 : 0;
    patch.surface_patch = source_.surface_patches.at(part_.begin);
    clear_places_between(patch);
    fits_ &= patch.total.mass < kMaxPatchMass;
    if (!fits_) atomicAdd(to_.misfits, 1);
    if (lane_ == 0) to_.patch[number_] = patch;
  }

  __device__ PatchBounds bounds_of_warp() const {
    const auto lowest = [](int32_t lo, int32_t from) { return int16_t(warp_min(lo) - from); };
    const auto highest = [](int32_t hi, int32_t from) { return int16_t(warp_max(hi) - from); };
    const PointQ8 box_lo = bounds_.lo, box_hi = bounds_.hi;
    const Normal8 lo = bounds_.normal_lo, hi = bounds_.normal_hi;
    return {origin_,
            pack({int8_t(warp_min(lo.x)), int8_t(warp_min(lo.y)), int8_t(warp_min(lo.z))}),
            {lowest(box_lo.x, origin_.x), lowest(box_lo.y, origin_.y), lowest(box_lo.z, origin_.z)},
            {highest(box_hi.x, origin_.x), highest(box_hi.y, origin_.y), highest(box_hi.z, origin_.z)},
            pack({int8_t(warp_max(hi.x)), int8_t(warp_max(hi.y)), int8_t(warp_max(hi.z))})};
  }

  /// Copies in steps of 16 bytes read the places up to the next patch.
  __device__ void clear_places_between(const Patch& patch) const {
    if (lane_ < round_up(patch.vertices) - patch.vertices)
      to_.vertex[vertex_first_ + patch.vertices + lane_] = {0, 0, 0, 0};
    if (lane_ < round_up(patch.triangles) - patch.triangles)
      to_.triangle[triangle_first_ + patch.triangles + lane_] = {0, 0};
  }

  const PatchSource& source_;
  const PatchTarget& to_;
  const int64_t number_;
  ForeignVertices<kSlots>& foreign_;
  PieceExchange& exchange_;
  const int lane_;
  const PatchSource::Part part_;
  const PointQ8 origin_;  ///< of local coordinates
  const int64_t vertex_first_, triangle_first_, owned_first_;
  int places_ = 0;  ///< vertices so far
  bool fits_ = true, has_fixed_ = false;
  label::Bounds bounds_ = label::empty_bounds();
  PieceSum total_{0, 0, 0, 0, 0};
};

template <int kSlots>
__global__ void fill_patches(PatchSource source, PatchTarget to) {
  __shared__ ForeignVertices<kSlots> foreign[kWarps];
  __shared__ PieceExchange exchange[kWarps];
  const int warp = int(threadIdx.x) >> 5;
  const int64_t number = int64_t(blockIdx.x) * kWarps + warp;
  if (number < source.patches) FillPatch<kSlots>(source, to, number, foreign[warp], exchange[warp]).run();
}

struct PatchTotals {
  int64_t vertices, triangles, owned, misfits;
};
__global__ void give_totals(PatchCounts first, int64_t patches, const int* misfits, PatchTotals* to, HostBell bell) {
  *to = {first.vertices[patches], first.triangles[patches], first.owned[patches], *misfits};
  ring(bell);
}
PatchTotals totals(CudaExecutor& exec, const PatchCounts& first, int64_t patches, const int* misfits) {
  DeviceStream& device = exec.device();
  PatchTotals* const total = static_cast<PatchTotals*>(device.pinned());
  give_totals<<<1, 1, 0, exec.stream()>>>(first, patches, misfits, total, device.next_bell());
  exec.check("count patches");
  device.wait_for_bell();
  return *total;
}

template <int kSlots>
SheetPatches make_with_slots(CudaExecutor& exec, const PatchSource& source, const FixedSeeds& fixed) {
  const int64_t count = source.patches;
  const unsigned blocks = unsigned((count + kWarps - 1) / kWarps);
  SheetPatches out;
  Buffer<int64_t> vertices = exec.make<int64_t>(count + 1), triangles = exec.make<int64_t>(count + 1),
                  owned = exec.make<int64_t>(count + 1);
  Buffer<int> misfits = exec.make<int>(1);
  exec.fill(misfits.view(), 0);
  const PatchCounts counts{vertices.data(), triangles.data(), owned.data()};
  count_patches<kSlots><<<blocks, kWarps * 32, 0, exec.stream()>>>(source, counts, misfits.data());
  exec.check("count patches");
  for (Buffer<int64_t>* number : {&vertices, &triangles, &owned}) exclusive_scan_async(exec.device(), number->view());
  const PatchTotals total = totals(exec, counts, count, misfits.data());
  out.fits = total.misfits == 0;
  if (!out.fits) return out;
  out.patch = exec.make<Patch>(count);
  out.vertex = exec.make<PatchVertex>(total.vertices);
  out.normal = exec.make<uint32_t>(total.vertices);
  out.triangle = exec.make<PackedTriangle>(total.triangles);
  out.owned = exec.make<PieceBytes>(total.owned);
  if (fixed.count > 0) out.fixed = exec.make<uint32_t>(total.vertices);
  fill_patches<kSlots><<<blocks, kWarps * 32, 0, exec.stream()>>>(
      source, {counts, out.patch.data(), out.vertex.data(), out.normal.data(), out.triangle.data(), out.owned.data(),
               out.fixed.data(), misfits.data()});
  exec.check("fill patches");
  out.fits = exec.value(View<const int>(misfits.view()), 0) == 0;
  return out;
}

}  // namespace

SheetPatches make_sheet_patches(CudaExecutor& exec, const SurfaceMesh& surface, const FixedSeeds& fixed, int max_own) {
  const Buffer<int64_t>& block_first = surface.blocks.first;
  Buffer<int64_t> patch_first = exec.make<int64_t>(block_first.size());
  const int64_t count =
      exec.exclusive_scan_of(block_first.size() - 1, PatchesOfBlock{block_first.view(), max_own}, patch_first.view());
  const PatchSource source{surface.blocks.view(),
                           surface.position.view(),
                           surface.normal.view(),
                           surface.triangles.view(),
                           surface.vertex_first.view(),
                           surface.vertex_triangles.view(),
                           lengths_of(surface),
                           {surface.patch.view(), {}},
                           fixed.count > 0 ? fixed.of_vertex.view() : View<const uint32_t>{},
                           patch_first.data(),
                           count};
  SheetPatches usual = make_with_slots<kUsualSlots>(exec, source, fixed);
  const bool has_room = usual.fits || !usual.patch.empty();  // else the table may have been too small
  return has_room ? std::move(usual) : make_with_slots<kMostSlots>(exec, source, fixed);
}

}  // namespace isoshell::cuda_relax
