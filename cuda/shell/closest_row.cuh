// The banded distance transform on leaf bitmaps (paper section 3.1), one warp a row of up to eight leaves along x.
//
// Along z the nearest sites come straight from the bits, along y and x from minima over the band. The passes along z
// and y run once a leaf and stay in shared memory until the x pass has used them, so no value is computed twice and
// none goes through device memory: a leaf of the row with nothing within the band in its own slice is no leaf of the
// shell, and what lies beyond it is out of reach.
#pragma once

#include "cuda/shell/closest_tables.cuh"

namespace isoshell {
namespace closest {

/// One warp's work. kBand 0 takes the band from the input.
template <int kReach, int kBand, class Keys>
class Worker {
  using W = Window<kReach>;
  using Pair = typename Keys::Pair;
  static constexpr int kUnroll = kBand > 0 ? 8 : 1;

 public:
  __device__ Worker(const Input& in, const Output& out, Shared<kReach, kBand, Keys>& shared, const uint32_t* table)
      : in_(in), out_(out), s_(shared), table_(table), lane_(int(threadIdx.x & 31)) {}

  __device__ void run(uint32_t first_leaf, int leaves) {
    const Voxel at = leaf_of_key(in_.shell.leaf_key[first_leaf]);
    const Voxel row = {at.x & ~7, at.y, at.z};
    const uint32_t shell_leaves = find_shell_leaves(row);
    const uint32_t present = (shell_leaves >> kReach) & ((1u << leaves) - 1) << (at.x & 7 & -leaves);
    const uint32_t occupied = find_site_leaves(row, __ffs(int(present)) - 1, 31 - __clz(int(present))) & shell_leaves;
    const uint32_t over_border = kLarge<Keys> || !site_order::is_mixed(row) ? 0 : 1u << site_order::border_leaf(row);
#pragma unroll 1
    for (int part = 0; part < 2; ++part) {
      const uint32_t of_part = part == 0 ? present & ~over_border : present & over_border;
      if (!of_part) continue;
      if (lane_ == 0) Keys::set_order(row, kReach, part != 0, s_.order);
      __syncwarp();
      if constexpr (Shared<kReach, kBand, Keys>::kNearest > 1) fill_along_z();
      __syncwarp();
      walk(of_part, occupied);
    }
  }

  /// Values for what is left of the voxels that may have sites as far as the band.
  __device__ void finish() {
    if constexpr (kFar) find_far_sites();
  }

 private:
  static constexpr bool kFar = kBand > kMostSteps<kBand>;
  __device__ int band() const { return kBand > 0 ? kBand : in_.band_vox; }
  __device__ int most_steps() const { return kBand > 0 ? kMostSteps<kBand> : in_.band_vox; }

  /// The leaves of a row, by place along x.
  __device__ void walk(uint32_t leaves, uint32_t occupied) {
    const int lo = __ffs(int(leaves)) - 1, hi = 31 - __clz(int(leaves));
    for (int place = lo; place <= hi + 2 * kReach; ++place) {
      if (occupied >> place & 1)
        pass_z_and_y(place);
      else if (lane_ == 0)
        s_.some[place] = 0;
      __syncwarp();
      const int leaf = place - 2 * kReach;
      if (leaf >= lo && (leaves >> leaf & 1)) pass_x(leaf);
      __syncwarp();
    }
  }
  __device__ uint32_t* plane(int place, int x) { return s_.keys[place % W::kSpan] + x * Keys::kPlaneWords; }

  __device__ uint32_t find_shell_leaves(Voxel row) {
    uint32_t leaf = kNone;
    if (lane_ < W::kPlaces) {
      leaf = find_leaf(in_.shell, {row.x - kReach + lane_, row.y, row.z});
      s_.shell_leaf[lane_] = leaf;
    }
    return __ballot_sync(kWholeWarp, leaf != kNone);
  }

  __device__ uint32_t find_site_leaves(Voxel row, int lo, int hi) {
    uint32_t occupied = 0;
#pragma unroll 1
    for (int i = lo * W::kSpan + lane_; i < (hi + W::kSpan) * W::kSpan; i += 32) {
      const int place = i / W::kSpan, y = i % W::kSpan;
      const Voxel first = {row.x - kReach + place, row.y - kReach + y, row.z - kReach};
      if (find_leaves_along_z(in_.sites, first, W::kSpan, s_.site_leaf + i * W::kSpan)) occupied |= 1u << place;
    }
    return warp_or(occupied);
  }

  /// For the window of a leaf, by place along x.
  __device__ void fill_sites(int leaf) {
    if (lane_ >= 27) return;
    const int x = lane_ / 9, y = lane_ / 3 % 3, z = lane_ % 3;
    const uint32_t digits = s_.order.digits[0][x] + s_.order.digits[1][y] + s_.order.digits[2][z];
    s_.sites[digits >> 3] = {s_.site_leaf[leaf * W::kColumns + lane_] * 8,
                             (leaf + x) % W::kSpan * int(sizeof(s_.keys[0])) | (8 - 8 * z) * (1 << 24)};
  }

  __device__ void fill_along_z() {
#pragma unroll 1
    for (int i = lane_; i < 4 * (most_steps() + 2); i += 32) {
      const int z = W::kMiddle + 2 * (i & 3), steps = i >> 2;
      s_.along_z[0][i & 3][most_steps() + 1 - steps] = Keys::from_below(s_.order, z, steps, most_steps(), band());
      s_.along_z[1][i & 3][steps] = Keys::from_above(s_.order, z, steps, most_steps(), band());
    }
  }

  __device__ uint64_t site_word(int place, int leaf_y, int leaf_z, int x) const {
    const uint32_t leaf = s_.site_leaf[place * W::kColumns + leaf_y * W::kSpan + leaf_z];
    return leaf == kNone ? 0
                         : __ldg(reinterpret_cast<const unsigned long long*>(&in_.words[int64_t(leaf) * 8 + x].bits));
  }

  __device__ void load_words(int place, int leaf_y, int x, uint64_t (&word)[W::kSpan]) const {
#pragma unroll
    for (int leaf_z = 0; leaf_z < W::kSpan; ++leaf_z) word[leaf_z] = site_word(place, leaf_y, leaf_z, x);
  }

  /// Keys of the leaf at `place` from the sites in its slice across x. A lane has one x and two z.
  __device__ void pass_z_and_y(int place) {
    Pair best[8];
#pragma unroll
    for (int y = 0; y < 8; ++y) best[y] = Keys::no_pair(band());
    const int x = lane_ >> 2, pair = lane_ & 3;
    if constexpr (kBand > 0 && kBand <= 3) {
      if (s_.order.jump_z == 0)
        rows_by_table<false>(place, x, pair, best);
      else
        rows_by_table<true>(place, x, pair, best);
    } else {
      rows_by_bits(place, x, pair, best);
    }
    uint32_t* to = plane(place, x) + pair * int(sizeof(Pair) / 4);
    Pair least = best[0];
#pragma unroll
    for (int y = 0; y < 8; ++y) {
      *reinterpret_cast<Pair*>(to + y * int(sizeof(Pair))) = best[y];
      least = Keys::smaller(least, best[y]);
    }
    const bool some = min(Keys::first(least), Keys::second(least)) < Keys::none(band());
    const uint32_t lanes = __ballot_sync(kWholeWarp, some);
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
      const Pair less = Keys::at_most(v, kMostSteps<kBand> * kMostSteps<kBand>);
#pragma unroll
      for (int to = 0; to < 8; ++to) {
        const int step = from - W::kMiddle - to;
        if (step < -kMostSteps<kBand> || step > kMostSteps<kBand>) continue;
        best[to] = Keys::lower(Keys::fits(step * step, kBand) ? v : less, Keys::cost(step * step), best[to]);
      }
    }
  }

  /// Bands up to 3: the table has the nearest sites of a pair by the bits around it.
  template <bool kBorderZ>
  __device__ void rows_by_table(int place, int x, int pair, Pair (&best)[8]) const {
    const RowsAround around(pair);
    const uint32_t* table = table_ + kNearestWords + pair * 256;
#pragma unroll
    for (int leaf = 0; leaf < 3; ++leaf) {
      const uint64_t middle = site_word(place, leaf, 1, x), other = site_word(place, leaf, around.other_leaf, x);
      const uint32_t code = Keys::row_code(s_.order, leaf, 0);
      const uint32_t bytes[2] = {around.of(uint32_t(middle), uint32_t(other)),
                                 around.of(uint32_t(middle >> 32), uint32_t(other >> 32))};
#pragma unroll
      for (int in_leaf = 0; in_leaf < 8; ++in_leaf) {
        const int y = leaf * 8 + in_leaf;
        if (y < W::kMiddle - kBand || y >= W::kMiddle + 8 + kBand) continue;
        Pair v = table[bytes[in_leaf >> 2] >> (8 * (in_leaf & 3)) & 255];
        if (kBorderZ) v = Keys::fix_z(s_.order, v);
        lower_all(v + code + uint32_t(in_leaf) * kBoth, y, best);
      }
    }
  }

  /// Keys along z from the sites among the bits of a row: z is the highest of `below`, z + 1 the lowest of
  /// `above`.
  __device__ Pair along_z(int pair, uint32_t below, uint32_t above) const {
    below |= 1u << (30 - most_steps());
    above |= 2u << most_steps();
    return Keys::smaller(s_.along_z[0][pair][1 + most_steps() - __clz(int(below))],
                         s_.along_z[1][pair][31 - __clz(int(above & (0 - above)))]);
  }

  /// Any band: nearest bits below and above the pair, row by row.
  __device__ void rows_by_bits(int place, int x, int pair, Pair (&best)[8]) const {
    const int z = W::kMiddle + 2 * pair;
    uint64_t words[kBand > 0 ? W::kSpan : 1][W::kSpan];  // loaded together where there are few
    if constexpr (kBand > 0)
#pragma unroll
      for (int leaf = 0; leaf < W::kSpan; ++leaf) load_words(place, leaf, x, words[leaf]);
#pragma unroll kUnroll
    for (int leaf = 0; leaf < W::kSpan; ++leaf) {
      if (leaf * 8 + 8 <= W::kMiddle - most_steps() || leaf * 8 >= W::kMiddle + 8 + most_steps()) continue;
      if constexpr (kBand == 0) load_words(place, leaf, x, words[0]);
      const uint64_t(&word)[W::kSpan] = words[kBand > 0 ? leaf : 0];
      uint64_t any = 0;
#pragma unroll
      for (int leaf_z = 0; leaf_z < W::kSpan; ++leaf_z) any |= word[leaf_z];
#pragma unroll kUnroll
      for (int half = 0; half < 2; ++half) {
        const uint32_t some = warp_or(uint32_t(any >> (32 * half)));
        if (!some) continue;
        uint32_t rows[W::kSpan];
#pragma unroll
        for (int leaf_z = 0; leaf_z < W::kSpan; ++leaf_z) rows[leaf_z] = uint32_t(word[leaf_z] >> (32 * half));
#pragma unroll
        for (int in_half = 0; in_half < 4; ++in_half) {
          const int in_leaf = half * 4 + in_half, y = leaf * 8 + in_leaf;
          if (y < W::kMiddle - most_steps() || y >= W::kMiddle + 8 + most_steps()) continue;
          if (!(some >> (8 * in_half) & 255)) continue;
          const Pair v = Keys::add_row(nearest_in_row(rows, in_half, pair, z), Keys::row_code(s_.order, leaf, in_leaf));
          lower_all(v, y, best);
        }
      }
    }
  }

  /// Rows of several leaves along z, four of each to a word.
  __device__ Pair nearest_in_row(const uint32_t (&rows)[W::kSpan], int row, int pair, int z) const {
    if constexpr (W::kSpan == 3) {
      const uint32_t two = __byte_perm(rows[0], rows[1], uint32_t(row | (4 + row) << 4));
      const uint32_t bits = __byte_perm(two, rows[2], uint32_t(0x10 | (4 + row) << 8));
      return along_z(pair, bits << (31 - z), bits >> (z + 1));
    } else {
      uint32_t low = 0, high = 0;
#pragma unroll
      for (int leaf_z = 0; leaf_z < W::kSpan; ++leaf_z)
        (leaf_z < 4 ? low : high) |= (rows[leaf_z] >> (8 * row) & 255) << (8 * (leaf_z & 3));
      return along_z(pair, low << (31 - z), __funnelshift_r(low, high, z + 1));
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
        if (x < W::kMiddle - most_steps() || x >= W::kMiddle + 8 + most_steps()) continue;
        if (kLarge<Keys> && !(some >> (4 * in_leaf) & 15)) continue;
        const Pair v = *reinterpret_cast<const Pair*>(from + in_leaf * Keys::kPlaneWords);
        lower_all(Keys::add_plane(v, Keys::plane_code(s_.order, l, leaf + l, in_leaf)), x, best);
      }
    }
    write_values(leaf, best);
  }

  /// Active voxels first go into a list, so that all lanes work on the next, longer step.
  __device__ void write_values(int leaf, const Pair (&best)[8]) {
    const uint32_t number = s_.shell_leaf[leaf + kReach];
    if constexpr (!kLarge<Keys>) fill_sites(leaf);
    const auto* mask = reinterpret_cast<const unsigned long long*>(in_.shell.mask.data[number].word);
    const uint64_t below = (uint64_t(1) << (2 * lane_)) - 1;
    int64_t start = in_.shell.first[number];
    int done = 0;
#pragma unroll 1
    for (int from = 0; from < 8; from += kListed<Keys>) {
      int count = 0;
#pragma unroll
      for (int x = 0; x < kListed<Keys>; ++x) {
        const uint64_t word = __ldg(mask + from + x);
        const uint32_t two = uint32_t(word >> (2 * lane_));
        const int at = count + __popcll(word & below);
        Pair v = best[x];
#pragma unroll
        for (int later = kListed<Keys>; later < 8; later += kListed<Keys>)
          if (from == later) v = best[later + x];
        const int offset = (from + x) * 64 + lane_ * 2;
        if (two & 1) put(at, Keys::first(v), offset);
        if (two & 2) put(at + int(two & 1), Keys::second(v), offset + 1);
        count += __popcll(word);
      }
      __syncwarp();
      write_list(start, count, number, done);
      start += count;
      done += count;
      __syncwarp();
    }
  }
  __device__ void put(int at, uint32_t key, int offset) {
    if constexpr (kLarge<Keys>) {
      s_.list[at] = key;
      s_.offset[at] = uint16_t(offset);
    } else {
      s_.list[at] = key << 16 | uint32_t(offset);
    }
  }

  /// Writes the values of `count` listed voxels; `done` of their leaf come before them.
  __device__ void write_list(int64_t start, int count, uint32_t leaf, int done) {
    uint32_t* const sites = out_.closest_site + start;
    uint16_t* const distances = out_.distance_sq_vox + start;
#pragma unroll 1
    for (int first = 0; first < count; first += 32) {
      const uint32_t i = uint32_t(first + lane_);
      uint32_t distance_sq = 0;
      int offset = 0;
      if (i < uint32_t(count)) {
        const uint32_t key = kLarge<Keys> ? s_.list[i] : s_.list[i] >> 16;
        offset = kLarge<Keys> ? s_.offset[i] : int(s_.list[i] & 511);
        distance_sq = key >> Keys::kBits;
        const bool beyond = kFar && distance_sq > uint32_t(kBand * kBand);  // the passes found no site
        sites[i] = beyond ? kNone : site_of(key, offset);
        distances[i] = uint16_t(beyond ? uint32_t(kBand * kBand) : distance_sq);
      }
      if constexpr (kFar) keep_far(distance_sq >= uint32_t(kBand * kBand), leaf, done + int(i), offset);
    }
  }

  /// Keeps this lane's voxel for find_far_sites if `far`.
  __device__ void keep_far(bool far, uint32_t leaf, int place, int offset) {
    const uint32_t lanes = __ballot_sync(kWholeWarp, far);
    if (!lanes) return;
    if (far) {
      const int at = far_count_ + lanes_before(lanes);
      s_.far.leaf[at] = leaf;
      s_.far.place[at] = uint32_t(place << 9 | offset);
    }
    far_count_ += __popc(lanes);
    if (far_count_ < 32) return;
    find_far_sites();
    far_count_ -= 32;
    __syncwarp();
    if (lane_ < far_count_) {
      s_.far.leaf[lane_] = s_.far.leaf[32 + lane_];
      s_.far.place[lane_] = s_.far.place[32 + lane_];
    }
    __syncwarp();
  }

  __device__ void find_far_sites() {
    __syncwarp();
    if (lane_ < far_count_) lower_to_far_site<kBand>(in_, out_, s_.far.leaf[lane_], s_.far.place[lane_]);
  }

  __device__ SiteWord word_of(uint32_t number) const {
    const uint4 raw = __ldg(reinterpret_cast<const uint4*>(&in_.words[number]));
    return {uint64_t(raw.x) | uint64_t(raw.y) << 32, raw.z};
  }

  __device__ uint32_t site_of(uint32_t key, int offset) const {
    if constexpr (kLarge<Keys>) {
      const int column = int(key >> 12 & 7) * W::kSpan + int(key >> 9 & 7);
      const uint32_t leaf = s_.site_leaf[int(key >> 15 & 15) * W::kColumns + column];
      return site_number(word_of(leaf * 8 + (key >> 6 & 7)), int(key & 63));
    } else {
      const SiteLeaf leaf = s_.sites[key >> 3 & 63];
      const uint32_t x = key & 7;
      const SiteWord word = word_of(leaf.first_word + x);
      const uint32_t plane = uint32_t(leaf.keys_and_z & 0xffff) + x * (4 * Keys::kPlaneWords);
      const uint32_t after_y = *reinterpret_cast<const uint16_t*>(reinterpret_cast<const char*>(s_.keys) + plane +
                                                                  uint32_t(offset & 63) * 2);
      const uint32_t y = after_y & 7;
      // Of the site's row the pass along z took the nearest one; seen from another leaf that is the first or last one.
      const int z = min(max((offset & 7) + (leaf.keys_and_z >> 24), 0), 7);
      const uint32_t row = uint32_t(word.bits >> (8 * y)) & 255;
      return site_number(word, int(8 * y + reinterpret_cast<const uint8_t*>(table_)[z * 256 + row]));
    }
  }

  const Input& in_;
  const Output& out_;
  Shared<kReach, kBand, Keys>& s_;
  const uint32_t* table_;
  const int lane_;
  int far_count_ = 0;
};

}  // namespace closest
}  // namespace isoshell
