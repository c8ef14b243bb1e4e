// The banded distance transform on leaf bitmaps (paper section 3.1), one warp a row of up to eight leaves along x.
//
// Along z the nearest sites come straight from the bits, along y and x from minima over the band. The passes along z
// and y run once a leaf and stay in shared memory until the x pass has used them, so no value is computed twice and
// none goes through device memory: a leaf of the row with nothing within the band in its own slice is no leaf of the
// shell, and what lies beyond it is out of reach.
#pragma once

#include "cuda/closest_tables.cuh"

namespace isoshell {
namespace closest {

/// One warp's work. kBand 0 takes the band from the input.
template <int kReach, int kBand, class Keys>
class Worker {
  using W = Window<kReach>;
  using Pair = typename Keys::Pair;
  static constexpr int kUnroll = kBand > 0 ? 8 : 1;

 public:
  __device__ Worker(const Input& in, const Output& out, Shared<Keys, kReach>& shared, const uint32_t* table)
      : in_(in), out_(out), s_(shared), table_(table), lane_(int(threadIdx.x & 31)) {}

  __device__ void run(uint32_t first_leaf, int leaves) {
    const Voxel at = leaf_of_key(in_.shell.leaf_key[first_leaf]);
    const Voxel row = {at.x & ~7, at.y, at.z};
    order_ = Keys::order(row, kReach);
    const uint32_t shell_leaves = find_shell_leaves(row);
    const uint32_t present = (shell_leaves >> kReach) & ((1u << leaves) - 1) << (at.x & 7 & -leaves);
    const int lo = __ffs(int(present)) - 1, hi = 31 - __clz(int(present));
    const uint32_t occupied = find_site_leaves(row, lo, hi) & shell_leaves;
    if constexpr (Keys::kDecoderEntries > 1) fill_decoder();
    if constexpr (kLarge<Keys>) fill_along_z();
    __syncwarp();
    for (int place = lo; place <= hi + 2 * kReach; ++place) {
      if (occupied >> place & 1)
        pass_z_and_y(place);
      else if (lane_ == 0)
        s_.some[place] = 0;
      __syncwarp();
      const int leaf = place - 2 * kReach;
      if (leaf >= lo && (present >> leaf & 1)) pass_x(leaf);
      __syncwarp();
    }
  }

 private:
  __device__ int band() const { return kBand > 0 ? kBand : in_.band_vox; }
  __device__ uint32_t* plane(int place, int x) { return s_.keys[place % W::kSpan] + x * Keys::kPlaneWords; }

  __device__ uint32_t find_shell_leaves(Voxel row) {
    uint32_t leaf = kNone;
    if (lane_ < W::kPlaces) {
      leaf = find_leaf(in_.shell, {row.x - kReach + lane_, row.y, row.z});
      s_.shell_leaf[lane_] = leaf;
    }
    return __ballot_sync(kAllLanes, leaf != kNone);
  }

  __device__ uint32_t find_site_leaves(Voxel row, int lo, int hi) {
    uint32_t occupied = 0;
#pragma unroll 1
    for (int i = lo * W::kColumns + lane_; i < (hi + W::kSpan) * W::kColumns; i += 32) {
      const int place = i / W::kColumns, column = i % W::kColumns;
      const uint32_t leaf = find_leaf(
          in_.sites, {row.x - kReach + place, row.y - kReach + column / W::kSpan, row.z - kReach + column % W::kSpan});
      s_.site_leaf[i] = leaf;
      if (leaf != kNone) occupied |= 1u << place;
    }
    return or_of_warp(occupied);
  }

  /// From the digits of a key to leaves in the window: their place in it, five bits, then two each for x, y and z.
  __device__ void fill_decoder() {
#pragma unroll 1
    for (int i = lane_; i < 54; i += 32) {
      const int x = i / 9 % 3, y = i / 3 % 3, z = i % 3;
      const int digits = order_.leaf(0, x, i >= 27) + order_.leaf(1, y, y >= order_.before[1]) +
                         order_.leaf(2, z, z >= order_.before[2]);
      s_.decoder[digits >> 3] = uint16_t((x * 9 + y * 3 + z) | x << 5 | y << 7 | z << 9);
    }
  }

  __device__ void fill_along_z() {
#pragma unroll 1
    for (int i = lane_; i < 4 * (band() + 2); i += 32) {
      const int z = W::kMiddle + 2 * (i & 3), steps = i >> 2;
      s_.along_z[0][i & 3][steps] = Keys::from_below(order_, z, steps, band());
      s_.along_z[1][i & 3][steps] = Keys::from_above(order_, z, steps, band());
    }
  }

  __device__ uint64_t site_word(int place, int leaf_y, int leaf_z, int x) const {
    const uint32_t leaf = s_.site_leaf[place * W::kColumns + leaf_y * W::kSpan + leaf_z];
    return leaf == kNone ? 0
                         : __ldg(reinterpret_cast<const unsigned long long*>(&in_.words[int64_t(leaf) * 8 + x].bits));
  }

  /// Keys of the leaf at `place` from the sites in its slice across x. A lane has one x and two z.
  __device__ void pass_z_and_y(int place) {
    Pair best[8];
#pragma unroll
    for (int y = 0; y < 8; ++y) best[y] = Keys::no_pair(band());
    const int x = lane_ >> 2, pair = lane_ & 3;
    if constexpr (kBand > 0 && kBand <= 3) {
      if (order_.jump[2] == 0)
        rows_by_table<false>(place, x, pair, best);
      else
        rows_by_table<true>(place, x, pair, best);
    } else {
      rows_by_bits(place, x, pair, best);
    }
    uint32_t* to = plane(place, x) + pair * int(sizeof(Pair) / 4);
    bool some = false;
#pragma unroll
    for (int y = 0; y < 8; ++y) {
      *reinterpret_cast<Pair*>(to + y * int(sizeof(Pair))) = best[y];
      some |= Keys::first(best[y]) < Keys::none(band()) || Keys::second(best[y]) < Keys::none(band());
    }
    const uint32_t lanes = __ballot_sync(kAllLanes, some);
    if (lane_ == 0) s_.some[place] = lanes;
  }

  /// Offers v, which is in row or plane `from` of the window, to the eight of the leaf.
  __device__ void lower_all(Pair v, int from, Pair (&best)[8]) const {
    if constexpr (kBand == 0) {
      const auto* costs = reinterpret_cast<const uint4*>(table_) + 2 * (from - W::kMiddle + band());
      const uint4 a = costs[0], b = costs[1];
      const uint32_t cost[8] = {a.x, a.y, a.z, a.w, b.x, b.y, b.z, b.w};
#pragma unroll
      for (int to = 0; to < 8; ++to) best[to] = Keys::lower(v, cost[to], best[to]);
    } else {
#pragma unroll
      for (int to = 0; to < 8; ++to) {
        const int step = from - W::kMiddle - to;
        if (step >= -kBand && step <= kBand) best[to] = Keys::lower(v, Keys::cost(step * step), best[to]);
      }
    }
  }

  /// Bands up to 3: the bits that matter to a pair are one byte a row.
  template <bool kBorderZ>
  __device__ void rows_by_table(int place, int x, int pair, Pair (&best)[8]) const {
    const int up = pair == 0 ? 3 : pair == 1 ? 1 : 0, down = pair == 2 ? 1 : pair == 3 ? 3 : 0;
    const uint32_t own = 0x01010101u * ((0xffu << up & 0xffu) >> down);
    const int side = pair < 2 ? 0 : 2, side_up = pair < 2 ? 0 : 8 - down, side_down = pair < 2 ? 8 - up : 0;
    const uint32_t* table = table_ + 8 + pair * 256;
#pragma unroll
    for (int leaf = 0; leaf < 3; ++leaf) {
      const uint64_t middle = site_word(place, leaf, 1, x), other = site_word(place, leaf, side, x);
      const uint32_t code = Keys::row_code(order_, leaf, 0);
      uint32_t bytes[2];
      bytes[0] = (uint32_t(middle) << up >> down & own) | (uint32_t(other) << side_up >> side_down & ~own);
      bytes[1] = (uint32_t(middle >> 32) << up >> down & own) | (uint32_t(other >> 32) << side_up >> side_down & ~own);
#pragma unroll
      for (int in_leaf = 0; in_leaf < 8; ++in_leaf) {
        const int y = leaf * 8 + in_leaf;
        if (y < W::kMiddle - kBand || y >= W::kMiddle + 8 + kBand) continue;
        Pair v = table[bytes[in_leaf >> 2] >> (8 * (in_leaf & 3)) & 255];
        if (kBorderZ) v = Keys::fix_z(order_, v);
        lower_all(v + code + uint32_t(in_leaf) * kBoth, y, best);
      }
    }
  }

  __device__ Pair along_z(int pair, uint32_t left, uint32_t right) const {
    const uint32_t stop = right | 2u << band();
    const Nearest nearest = {W::kMiddle + 2 * pair, __clz(int(left)) - 31 + band(), 31 - __clz(int(stop & (0 - stop)))};
    if constexpr (kLarge<Keys>)
      return Keys::lower(s_.along_z[0][pair][nearest.left], 0, s_.along_z[1][pair][nearest.right]);
    else
      return Keys::along_z(order_, nearest);
  }

  /// Any band: nearest bits below and above the pair, row by row.
  __device__ void rows_by_bits(int place, int x, int pair, Pair (&best)[8]) const {
    const int z = W::kMiddle + 2 * pair;
    const uint32_t window = (2u << band()) - 1;
#pragma unroll kUnroll
    for (int leaf = 0; leaf < W::kSpan; ++leaf) {
      if (leaf * 8 + 8 <= W::kMiddle - band() || leaf * 8 >= W::kMiddle + 8 + band()) continue;
      uint64_t word[W::kSpan], any = 0;
#pragma unroll
      for (int leaf_z = 0; leaf_z < W::kSpan; ++leaf_z) any |= word[leaf_z] = site_word(place, leaf, leaf_z, x);
      if (!__any_sync(kAllLanes, any != 0)) continue;
#pragma unroll kUnroll
      for (int half = 0; half < 2; ++half) {
        uint32_t rows[W::kSpan];
#pragma unroll
        for (int leaf_z = 0; leaf_z < W::kSpan; ++leaf_z) rows[leaf_z] = uint32_t(word[leaf_z] >> (32 * half));
#pragma unroll
        for (int in_half = 0; in_half < 4; ++in_half) {
          const int in_leaf = half * 4 + in_half, y = leaf * 8 + in_leaf;
          if (y < W::kMiddle - band() || y >= W::kMiddle + 8 + band()) continue;
          uint32_t low = 0, high = 0;
#pragma unroll
          for (int leaf_z = 0; leaf_z < W::kSpan; ++leaf_z)
            (leaf_z < 4 ? low : high) |= (rows[leaf_z] >> (8 * in_half) & 255) << (8 * (leaf_z & 3));
          const uint32_t left = __funnelshift_r(low, high, z - band()) & window;
          const uint32_t right = __funnelshift_r(low, high, z + 1) & window;
          if (!__any_sync(kAllLanes, (left | right) != 0)) continue;
          lower_all(Keys::add_row(along_z(pair, left, right), Keys::row_code(order_, leaf, in_leaf)), y, best);
        }
      }
    }
  }

  /// A lane has one y and two z of every plane.
  __device__ void pass_x(int leaf) {
    Pair best[8];
#pragma unroll
    for (int x = 0; x < 8; ++x) best[x] = Keys::no_pair(band());
#pragma unroll kUnroll
    for (int l = 0; l < W::kSpan; ++l) {
      const uint32_t some = s_.some[leaf + l];
      if (!some) continue;
      const uint32_t* from = plane(leaf + l, 0) + lane_ * int(sizeof(Pair) / 4);
#pragma unroll kUnroll
      for (int in_leaf = 0; in_leaf < 8; ++in_leaf) {
        const int x = l * 8 + in_leaf;
        if (x < W::kMiddle - band() || x >= W::kMiddle + 8 + band()) continue;
        if (!(some >> (4 * in_leaf) & 15)) continue;
        const Pair v = *reinterpret_cast<const Pair*>(from + in_leaf * Keys::kPlaneWords);
        lower_all(Keys::add_plane(v, Keys::plane_code(order_, l, leaf + l, in_leaf)), x, best);
      }
    }
    if constexpr (Keys::kValues)
      write_values(leaf, best);
    else
      write_mask(s_.shell_leaf[leaf + kReach], best);
  }

  __device__ static uint64_t spread(uint32_t bits) {
    uint64_t b = bits;
    b = (b | b << 16) & 0x0000ffff0000ffffull;
    b = (b | b << 8) & 0x00ff00ff00ff00ffull;
    b = (b | b << 4) & 0x0f0f0f0f0f0f0f0full;
    b = (b | b << 2) & 0x3333333333333333ull;
    return (b | b << 1) & 0x5555555555555555ull;
  }

  __device__ void write_mask(uint32_t leaf, const Pair (&best)[8]) {
    uint32_t even = 0, odd = 0;
#pragma unroll
    for (int x = 0; x < 8; ++x) {
      const uint32_t lo = __ballot_sync(kAllLanes, Keys::first(best[x]) < Keys::none(band()));
      const uint32_t hi = __ballot_sync(kAllLanes, Keys::second(best[x]) < Keys::none(band()));
      if (lane_ == x) even = lo, odd = hi;
    }
    int voxels = __popc(even) + __popc(odd);
    if (lane_ < 8) out_.mask[leaf].word[lane_] = spread(even) | spread(odd) << 1;
    for (int offset = 4; offset > 0; offset >>= 1) voxels += __shfl_xor_sync(kAllLanes, voxels, offset);
    if (lane_ == 0) out_.count[leaf] = voxels;
  }

  /// Active voxels first go into a list, so that all lanes work on the next, longer step.
  __device__ void write_values(int leaf, const Pair (&best)[8]) {
    const uint32_t number = s_.shell_leaf[leaf + kReach];
    const auto* mask = reinterpret_cast<const unsigned long long*>(in_.shell.mask.data[number].word);
    const uint64_t below = (uint64_t(1) << (2 * lane_)) - 1;
    int before = lane_ < 8 ? __popcll(__ldg(mask + lane_)) : 0;  // of the words up to this lane's
    for (int offset = 1; offset < 8; offset <<= 1) {
      const int other = __shfl_up_sync(kAllLanes, before, unsigned(offset));
      if (lane_ >= offset) before += other;
    }
    const int64_t start = in_.shell.first[number];
    uint32_t* sites = out_.closest_site + start;
    uint16_t* distances = out_.distance_sq_vox + start;
#pragma unroll
    for (int from = 0; from < 8; from += kListed<Keys>) {
      const int done = from == 0 ? 0 : __shfl_sync(kAllLanes, before, from - 1);
      const int count = __shfl_sync(kAllLanes, before, from + kListed<Keys> - 1) - done;
#pragma unroll
      for (int x = from; x < from + kListed<Keys>; ++x) {
        int at = __popcll(__ldg(mask + x) & below);
        if (x > from) at += __shfl_sync(kAllLanes, before, x - 1) - done;
        const bool first = Keys::first(best[x]) < Keys::none(band());
        if (first) put(at, Keys::first(best[x]), x * 64 + lane_ * 2);
        if (Keys::second(best[x]) < Keys::none(band())) put(at + first, Keys::second(best[x]), x * 64 + lane_ * 2 + 1);
      }
      __syncwarp();
#pragma unroll 1
      for (int i = lane_; i < count; i += 32) {
        const uint32_t key = kLarge<Keys> ? s_.list[i] : s_.list[i] >> 16;
        const int offset = kLarge<Keys> ? s_.offset[i] : int(s_.list[i] & 511);
        sites[done + i] = site_of(leaf, key, offset);
        distances[done + i] = uint16_t(key >> Keys::kBits);
      }
      if (from + kListed<Keys> < 8) __syncwarp();
    }
  }
  __device__ void put(int at, uint32_t key, int offset) {
    if constexpr (sizeof(Pair) > 4) {
      s_.list[at] = key;
      s_.offset[at] = uint16_t(offset);
    } else {
      s_.list[at] = key << 16 | uint32_t(offset);
    }
  }

  __device__ SiteWord word_of(uint32_t leaf, int x) const {
    const uint4 raw = __ldg(reinterpret_cast<const uint4*>(&in_.words[int64_t(leaf) * 8 + x]));
    return {uint64_t(raw.x) | uint64_t(raw.y) << 32, raw.z};
  }
  __device__ static uint32_t site_number(const SiteWord& word, int bit) {
    return word.first + uint32_t(__popcll(word.bits & ((uint64_t(1) << bit) - 1)));
  }

  __device__ uint32_t site_of(int leaf, uint32_t key, int offset) {
    if constexpr (kLarge<Keys>) {
      const int column = int(key >> 12 & 7) * W::kSpan + int(key >> 9 & 7), x = int(key >> 6 & 7);
      return site_number(word_of(s_.site_leaf[int(key >> 15 & 15) * W::kColumns + column], x), int(key & 63));
    } else {
      const int where = s_.decoder[key >> 3 & 127], x = int(key & 7);
      const SiteWord word = word_of(s_.site_leaf[leaf * W::kColumns + (where & 31)], x);
      const int leaf_y = where >> 7 & 3, leaf_z = where >> 9, z = offset & 7;
      int slot = leaf % W::kSpan + (where >> 5 & 3);
      if (slot >= W::kSpan) slot -= W::kSpan;
      const auto* after_y = reinterpret_cast<const uint16_t*>(s_.keys[slot] + x * Keys::kPlaneWords);
      const uint32_t key_y = after_y[offset & 63];
      const int y = int(key_y & 7), dy = leaf_y * 8 + y - W::kMiddle - (offset >> 3 & 7);
      const int dz = reinterpret_cast<const uint8_t*>(table_)[int(key_y >> Keys::kBits) - dy * dy];
      // In the voxel's own leaf both ends of the distance may hold a site; the lower one comes first.
      const int low = z - dz, place_low = y * 8 + (low & 7);
      const bool below = leaf_z == 0 || (leaf_z == 1 && low >= 0 && (word.bits >> place_low & 1));
      return site_number(word, below ? place_low : y * 8 + ((z + dz) & 7));
    }
  }

  const Input& in_;
  const Output& out_;
  Shared<Keys, kReach>& s_;
  const uint32_t* table_;
  const int lane_;
  typename Keys::Order order_;
};

template <int kReach, int kBand, class Keys>
constexpr int64_t shared_bytes() {
  return int64_t(sizeof(Shared<Keys, kReach>)) * kWarps<Keys, kReach> + 4 * kTableWords<kBand>;
}

template <int kReach, int kBand, class Keys>
__global__ void __launch_bounds__(kWarps<Keys, kReach> * 32) closest_sites(Rows rows, Input in, Output out) {
  extern __shared__ uint4 memory[];
  auto* shared = reinterpret_cast<Shared<Keys, kReach>*>(memory);
  auto* table = reinterpret_cast<uint32_t*>(shared + kWarps<Keys, kReach>);
  fill_tables<kBand, Keys>(table, in.band_vox);
  __syncthreads();
  Worker<kReach, kBand, Keys> worker(in, out, shared[threadIdx.x >> 5], table);
  const uint32_t count = *rows.count;
  for (;;) {
    uint32_t row = 0;
    if ((threadIdx.x & 31) == 0) row = atomicAdd(rows.next, 1u);
    row = __shfl_sync(kAllLanes, row, 0);
    if (row >= count) return;
    worker.run(rows.first_leaf[row], rows.leaves);
  }
}

}  // namespace closest
}  // namespace isoshell
