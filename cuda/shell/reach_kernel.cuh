// Which voxels of a row of leaves lie within the band of a site: the sites' bitmaps grown by the ball, 64 voxels at a
// time. Bits only: z by shifts, y by bytes, x through shared memory.
#pragma once

#include "cuda/shell/closest_tables.cuh"

namespace isoshell {
namespace reach {

/// The largest k with k k <= n; -1 for negative n.
ISOSHELL_HD constexpr int root_of(int n) {
  int k = -1;
  while ((k + 1) * (k + 1) <= n) ++k;
  return k;
}
/// Rows from the nearest row of a leaf to the four rows from 4 quad on.
ISOSHELL_HD constexpr int quad_gap(int quad) { return quad < 0 ? -4 * quad - 3 : quad > 1 ? 4 * quad - 7 : 0; }
/// Largest integer not above quad / 2.
ISOSHELL_HD constexpr int leaf_of_quad(int quad) { return (quad + 64) / 2 - 32; }

template <int kBand>
struct Shape {
  static constexpr int kSq = kBand * kBand;
  static constexpr int kReach = (kBand + 7) / 8, kSpan = 2 * kReach + 1;
  static constexpr int kPlaces = site_order::kRowLeaves + 2 * kReach;  ///< of leaves along x
  static constexpr int kLowQuad = -((kBand + 3) / 4), kQuads = (7 + kBand) / 4 + 1 - kLowQuad;
  static constexpr int kPad = (8 - 2 * kBand % 8) % 8;  ///< planes in front, so that results start at a leaf
  static constexpr int kRing = 32 + 2 * kBand <= 64 ? 64 : 128;

  ISOSHELL_HD static constexpr bool is_column(int leaf_y, int leaf_z) {
    return closest::leaf_gap(leaf_y) * closest::leaf_gap(leaf_y) +
               closest::leaf_gap(leaf_z) * closest::leaf_gap(leaf_z) <=
           kSq;
  }
};

template <int kBand>
struct alignas(16) Shared {
  using S = Shape<kBand>;
  uint64_t disc[kBand + 1][S::kRing];  ///< by distance along x, plane: voxels of the plane that are near enough
  uint32_t site_leaf[S::kPlaces][S::kSpan][S::kSpan];
  uint32_t shell_leaf[site_order::kRowLeaves];
};

/// A thread block, so that it fits the smallest chip's shared memory.
template <int kBand>
constexpr int kWarps = 4 * sizeof(Shared<kBand>) < 59000 ? 4 : 2;

template <int kBand>
class Worker {
  using S = Shape<kBand>;

 public:
  __device__ Worker(const closest::Input& in, const closest::Output& out, Shared<kBand>& shared)
      : in_(in), out_(out), s_(shared), lane_(int(threadIdx.x & 31)) {}

  __device__ void run(uint32_t first_leaf, int leaves) {
    const Voxel at = leaf_of_key(in_.shell.leaf_key[first_leaf]);
    const Voxel row = {at.x & ~(site_order::kRowLeaves - 1), at.y, at.z};
    const uint32_t present = find_shell_leaves(row) & ((1u << leaves) - 1) << (at.x & 7 & -leaves);
    const int lo = __ffs(int(present)) - 1, hi = 31 - __clz(int(present));
    find_site_leaves(row, lo, hi);
    __syncwarp();
    const int end = 8 * hi + 8 + kBand;
    for (int first = 8 * lo - kBand - S::kPad; first < end; first += 32) {
      find_discs(first + lane_, 8 * (lo - S::kReach), 8 * (hi + 1 + S::kReach));
      __syncwarp();
      join_discs(first + lane_ - kBand, present);
      __syncwarp();
    }
  }

 private:
  __device__ uint32_t find_shell_leaves(Voxel row) {
    uint32_t leaf = kNone;
    if (lane_ < site_order::kRowLeaves) {
      leaf = find_leaf(in_.shell, {row.x + lane_, row.y, row.z});
      s_.shell_leaf[lane_] = leaf;
    }
    return __ballot_sync(kWholeWarp, leaf != kNone);
  }

  __device__ void find_site_leaves(Voxel row, int lo, int hi) {
#pragma unroll 1
    for (int i = lo * S::kSpan + lane_; i < (hi + S::kSpan) * S::kSpan; i += 32) {
      const int place = i / S::kSpan, y = i % S::kSpan;
      const Voxel first = {row.x - S::kReach + place, row.y - S::kReach + y, row.z - S::kReach};
      closest::find_leaves_along_z(in_.sites, first, S::kSpan, s_.site_leaf[place][y]);
    }
  }

  /// Sites of a plane across x: by leaf along z, four rows along y in a word.
  using PlaneSites = uint32_t[S::kSpan][2 * S::kSpan];
  /// Voxels of a plane of a leaf that are near enough to sites of a plane `x` voxels away: by x, and halves of the
  /// leaf.
  using Discs = uint32_t[kBand + 1][2];

  /// For every distance along x, the voxels across x in the plane's disc of that radius; plane counts from the row.
  __device__ void find_discs(int plane, int lo, int hi) {
    const int slot = plane & (S::kRing - 1);
    PlaneSites site;
    const bool any = load_plane(plane, plane >= lo && plane < hi, site);
    if (!__any_sync(kWholeWarp, any)) {
#pragma unroll
      for (int x = 0; x <= kBand; ++x) s_.disc[x][slot] = 0;
      return;
    }
    uint32_t grown[S::kQuads] = {};
    Discs disc = {};
#pragma unroll
    for (int z = 0; z <= kBand; ++z) {
      grow_along_z(site, z, grown);
      grow_along_y(grown, z, disc);
    }
    store_discs(disc, slot);
  }

  /// True when the lane's plane has sites.
  __device__ bool load_plane(int plane, bool inside, PlaneSites& site) const {
    uint32_t any = 0;
#pragma unroll
    for (int y = -S::kReach; y <= S::kReach; ++y)
#pragma unroll
      for (int z = -S::kReach; z <= S::kReach; ++z) {
        uint64_t word = 0;
        if (S::is_column(y, z) && inside) {
          const uint32_t leaf = s_.site_leaf[(plane >> 3) + S::kReach][y + S::kReach][z + S::kReach];
          if (leaf != kNone)
            word = __ldg(reinterpret_cast<const unsigned long long*>(&in_.sites.mask.data[leaf].word[plane & 7]));
        }
        site[z + S::kReach][2 * (y + S::kReach)] = uint32_t(word);
        site[z + S::kReach][2 * (y + S::kReach) + 1] = uint32_t(word >> 32);
        any |= uint32_t(word) | uint32_t(word >> 32);
      }
    return any != 0;
  }

  /// Adds the sites moved by z voxels along z to those moved by less. Only rows that some disc reaches from there.
  __device__ static void grow_along_z(const PlaneSites& site, int z, uint32_t (&grown)[S::kQuads]) {
#pragma unroll
    for (int q = 0; q < S::kQuads; ++q) {
      const int gap = quad_gap(q + S::kLowQuad), leaf = leaf_of_quad(q + S::kLowQuad);
      if (gap * gap + z * z <= S::kSq)
        grown[q] |= moved(site, 2 * (leaf + S::kReach) + (q + S::kLowQuad - 2 * leaf), z);
    }
  }

  /// Adds the rows that were grown by z along z, moved along y, to the largest disc that holds such a move. The other
  /// discs follow in store_discs.
  __device__ static void grow_along_y(const uint32_t (&grown)[S::kQuads], int z, Discs& disc) {
#pragma unroll
    for (int y = 0; y <= kBand; ++y) {
      const int x = root_of(S::kSq - z * z - y * y);
      if (x < 0 || x == root_of(S::kSq - (z + 1) * (z + 1) - y * y)) continue;  // the next z has it all
#pragma unroll
      for (int half = 0; half < 2; ++half) disc[x][half] |= rows(grown, 4 * half + y) | rows(grown, 4 * half - y);
    }
  }

  /// A disc holds those of greater distances along x.
  __device__ void store_discs(Discs& disc, int slot) const {
#pragma unroll
    for (int x = kBand; x >= 0; --x) {
      if (x < kBand) disc[x][0] |= disc[x + 1][0], disc[x][1] |= disc[x + 1][1];
      s_.disc[x][slot] = uint64_t(disc[x][0]) | uint64_t(disc[x][1]) << 32;
    }
  }

  /// Four rows of the sites moved by `by` voxels up and down along z.
  __device__ static uint32_t moved(const PlaneSites& site, int quad, int by) {
    const int leaves = by / 8, bits = by % 8;
    const uint32_t up = 0x01010101u * (0xffu << bits & 0xffu), down = 0x01010101u * (0xffu >> bits);
    const auto at = [&](int leaf) {
      return leaf >= -S::kReach && leaf <= S::kReach ? site[leaf + S::kReach][quad] : 0;
    };
    if (bits == 0) return at(-leaves) | at(leaves);
    return (at(-leaves) << bits & up) | (at(-leaves - 1) >> (8 - bits) & ~up) | (at(leaves) >> bits & down) |
           (at(leaves + 1) << (8 - bits) & ~down);
  }

  /// The four rows from `row` of the leaf on.
  __device__ static uint32_t rows(const uint32_t (&grown)[S::kQuads], int row) {
    const int quad = (row + 64) / 4 - 16 - S::kLowQuad, bytes = (row + 64) % 4;
    const auto at = [&](int q) { return q >= 0 && q < S::kQuads ? grown[q] : 0; };
    return bytes == 0 ? at(quad) : __funnelshift_r(at(quad), at(quad + 1), 8 * bytes);
  }

  /// The mask's word of this plane, and the number of voxels of its leaf.
  __device__ void join_discs(int plane, uint32_t present) {
    uint64_t word = 0;
#pragma unroll
    for (int x = -kBand; x <= kBand; ++x) word |= s_.disc[x < 0 ? -x : x][(plane + x) & (S::kRing - 1)];
    const int voxels = warp_sum<8>(__popcll(word));
    const int place = plane >> 3;
    if (place < 0 || place >= site_order::kRowLeaves || !(present >> place & 1)) return;
    const uint32_t leaf = s_.shell_leaf[place];
    out_.mask[leaf].word[plane & 7] = word;
    if ((lane_ & 7) == 0) out_.count[leaf] = voxels;
  }

  const closest::Input& in_;
  const closest::Output& out_;
  Shared<kBand>& s_;
  const int lane_;
};

/// A warp a row.
template <int kBand>
__global__ void __launch_bounds__(kWarps<kBand> * 32)
    grow_sites(closest::Rows rows, closest::Input in, closest::Output out) {
  extern __shared__ uint4 memory[];
  Worker<kBand> worker(in, out, reinterpret_cast<Shared<kBand>*>(memory)[threadIdx.x >> 5]);
  const uint32_t count = *rows.count;
  for (;;) {
    uint32_t row = 0;
    if ((threadIdx.x & 31) == 0) row = atomicAdd(rows.next, 1u);
    row = __shfl_sync(kWholeWarp, row, 0);
    if (row >= count) return;
    worker.run(rows.first_leaf[row], rows.leaves);
  }
}

}  // namespace reach
}  // namespace isoshell
