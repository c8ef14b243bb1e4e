// Separable passes of the banded distance transform over one leaf (paper section 3.1): z from the bitmap, then y, then
// x. A row of eight voxels along z is one vector; the compiler makes versions for machines with and without wide
// vectors.
#include "cpu/shell/leaf_simd.h"

#include <cstring>
#include <type_traits>

#include "core/vector_versions.h"

namespace isoshell {
namespace {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "rows of a mask word are read as bytes");

using Lanes = uint32_t __attribute__((vector_size(32)));

constexpr int kMaxRows = 8 + 2 * kMaxBandVox;  ///< rows of the halo of a leaf, per axis
constexpr int kMaxReach = 3;

/// Squared distances from the eight voxels of a row to a site `s - 8 * kMaxReach` voxels from its first, and from all
/// eight to a row `s - kMaxBandVox` away.
struct Tables {
  alignas(32) uint32_t along[8 * (2 * kMaxReach + 1)][8];
  alignas(32) uint32_t across[2 * kMaxBandVox + 1][8];
};
constexpr Tables make_tables() {
  Tables t{};
  for (int s = 0; s < 8 * (2 * kMaxReach + 1); ++s)
    for (int z = 0; z < 8; ++z) t.along[s][z] = key_of_distance_sq((s - 8 * kMaxReach - z) * (s - 8 * kMaxReach - z));
  for (int s = 0; s <= 2 * kMaxBandVox; ++s)
    for (int z = 0; z < 8; ++z) t.across[s][z] = key_of_distance_sq((s - kMaxBandVox) * (s - kMaxBandVox));
  return t;
}
constexpr Tables kTables = make_tables();

ISOSHELL_INLINE void lower_to(Lanes& best, const Lanes& key) { best = key < best ? key : best; }
ISOSHELL_INLINE const Lanes& lanes(const uint32_t (&row)[8]) { return reinterpret_cast<const Lanes&>(row); }

/// One plane of constant x of the cube of leaves, as rows along z: bit 8 * l + z of a row is voxel z of leaf l.
/// Three leaves fit 32 bits, which keeps twice as many rows in a vector.
template <int kSpan>
struct Plane {
  using Row = std::conditional_t<kSpan == 3, uint32_t, uint64_t>;
  static constexpr int kRows = 8 * kSpan;
  alignas(32) Row rows[kRows];
};

/// Returns false, with the plane undefined, when there is no site in it.
template <int kSpan>
ISOSHELL_INLINE bool gather_plane(const Neighbourhood& around, const LeafMask* sites, int x, Plane<kSpan>& plane) {
  using Row = typename Plane<kSpan>::Row;
  const uint32_t* leaf = &around.leaf[(x >> 3) * kSpan * kSpan];
  uint64_t word[kSpan][kSpan], any = 0;
  for (int y = 0; y < kSpan; ++y)
    for (int z = 0; z < kSpan; ++z, ++leaf) any |= word[y][z] = *leaf == kNone ? 0 : sites[*leaf].word[x & 7];
  if (!any) return false;
  for (int y = 0; y < kSpan; ++y) {
    Row rows[8] = {};
    for (int z = 0; z < kSpan; ++z) {
      uint8_t bytes[8];
      std::memcpy(bytes, &word[y][z], 8);
      for (int i = 0; i < 8; ++i) rows[i] |= Row(bytes[i]) << (8 * z);
    }
    std::memcpy(plane.rows + 8 * y, rows, sizeof rows);
  }
  return true;
}

/// Of the sites in a row, those that can be the closest of a voxel in the middle leaf: all inside it, one on either
/// side.
ISOSHELL_INLINE uint64_t useful_bits(uint64_t row, int middle) {
  const uint64_t left = row & ((uint64_t(1) << middle) - 1), right = row >> (middle + 8) << (middle + 8);
  uint64_t useful = row & (uint64_t(255) << middle);
  if (left) useful |= uint64_t(1) << (63 - __builtin_clzll(left));
  return useful | (right & (~right + 1));
}

/// The z pass over one plane: best keys of the middle eight voxels of every row. Returns which rows have any.
template <int kSpan>
ISOSHELL_INLINE uint64_t pass_z(const Neighbourhood& around, const Plane<kSpan>& plane, int x, int band, Lanes* rows) {
  const int middle = 8 * (kSpan / 2), lowest = middle - band, count = 8 + 2 * band;
  const uint64_t window = ((uint64_t(1) << count) - 1) << lowest;
  const Lanes none = Lanes{} + kNoKey;
  uint64_t used = 0;
  for (int j = 0; j < count; ++j) {
    const int y = lowest + j;
    const uint64_t row = plane.rows[y] & window;
    Lanes best = none;
    if (row) {
      const uint16_t* place = &around.place[around.at(x >> 3, y >> 3, 0)];
      const int in_plane = (x & 7) << 6 | (y & 7) << 3;
      for (uint64_t bits = useful_bits(row, middle); bits; bits &= bits - 1) {
        const int z = __builtin_ctzll(bits);
        const uint32_t rank = uint32_t(place[z >> 3]) << 9 | uint32_t(in_plane | (z & 7));
        lower_to(best, lanes(kTables.along[z - middle + 8 * kMaxReach]) + rank);
      }
      used |= uint64_t(1) << j;
    }
    rows[j] = best;
  }
  return used;
}

/// One row of the y or x pass: the smallest of the inputs `stride` apart within the band, each plus its distance.
ISOSHELL_INLINE void pass_across(const Lanes* in, int stride, int at, int band, int first, int last, Lanes& best) {
  const int from = at > first ? at : first, to = at + 2 * band < last ? at + 2 * band : last;
  best = Lanes{} + kNoKey;
  if (from > to) return;
  const uint32_t(*distance)[8] = &kTables.across[kMaxBandVox + from - at - band];
  for (int j = from; j <= to; ++j, ++distance) lower_to(best, in[j * stride] + lanes(*distance));
}

template <int kSpan>
ISOSHELL_INLINE void closest_within(const Neighbourhood& around, const LeafMask* sites, int band_vox, uint32_t* keys) {
  const int lowest = 8 * (kSpan / 2) - band_vox, count = 8 + 2 * band_vox;
  Plane<kSpan> plane;
  Lanes rows[kMaxRows], planes[kMaxRows * 8];
  const Lanes none = Lanes{} + kNoKey;
  int first = count, last = -1;
  for (int i = 0; i < count; ++i) {
    uint64_t used = 0;
    if (gather_plane(around, sites, lowest + i, plane)) used = pass_z(around, plane, lowest + i, band_vox, rows);
    if (!used) {
      for (int y = 0; y < 8; ++y) planes[i * 8 + y] = none;
      continue;
    }
    first = first < i ? first : i;
    last = i;
    const int first_row = __builtin_ctzll(used), last_row = 63 - __builtin_clzll(used);
    for (int y = 0; y < 8; ++y) pass_across(rows, 1, y, band_vox, first_row, last_row, planes[i * 8 + y]);
  }
  for (int x = 0; x < 8; ++x)
    for (int y = 0; y < 8; ++y) {
      Lanes best;
      pass_across(planes + y, 8, x, band_vox, first, last, best);
      std::memcpy(keys + x * 64 + y * 8, &best, sizeof best);
    }
}

template <int kSpan>
ISOSHELL_INLINE void reached_within(const Neighbourhood& around, const LeafMask* sites, const Ball& ball,
                                    LeafMask& out) {
  using Row = typename Plane<kSpan>::Row;
  constexpr int kMiddle = 8 * (kSpan / 2), kRows = Plane<kSpan>::kRows;
  const int radius = ball.radius;
  Plane<kSpan> plane;
  // grown[w][y]: row y's voxels in the middle leaf that are at most w from a site of that row.
  alignas(32) uint8_t grown[kMaxBandVox + 1][kRows];
  for (uint64_t& word : out.word) word = 0;
  for (int i = 0; i < 8 + 2 * radius; ++i) {
    if (!gather_plane(around, sites, kMiddle - radius + i, plane)) continue;
    alignas(32) Row spread[kRows];
    for (int y = 0; y < kRows; ++y) {
      spread[y] = plane.rows[y];
      grown[0][y] = uint8_t(spread[y] >> kMiddle);
    }
    const int outside = i < radius ? radius - i : i > radius + 7 ? i - radius - 7 : 0;
    for (int w = 1; w <= ball.half[outside][0]; ++w)
      for (int y = 0; y < kRows; ++y) {
        spread[y] |= plane.rows[y] << w | plane.rows[y] >> w;
        grown[w][y] = uint8_t(spread[y] >> kMiddle);
      }
    for (int x = i > 2 * radius ? i - 2 * radius : 0; x < 8 && x <= i; ++x) {
      const int dx = i - radius - x < 0 ? x + radius - i : i - radius - x;
      for (int dy = -ball.half[dx][0]; dy <= ball.half[dx][0]; ++dy) {
        uint64_t eight_rows;
        std::memcpy(&eight_rows, &grown[ball.half[dx][dy < 0 ? -dy : dy]][kMiddle + dy], 8);
        out.word[x] |= eight_rows;
      }
    }
  }
}

}  // namespace

ISOSHELL_VECTOR_VERSIONS
void LeafSimd::closest(const Neighbourhood& around, const LeafMask* sites, const uint32_t* word_first, int band_vox,
                       const LeafMask& reached, uint32_t* closest_site, uint16_t* distance_sq_vox) {
  alignas(32) uint32_t keys[512];
  if (around.span == 3)
    closest_within<3>(around, sites, band_vox, keys);
  else if (around.span == 5)
    closest_within<5>(around, sites, band_vox, keys);
  else
    closest_within<7>(around, sites, band_vox, keys);
  int64_t at = 0;
  for (int w = 0; w < 8; ++w)
    for (uint64_t bits = reached.word[w]; bits; bits &= bits - 1, ++at) {
      const uint32_t key = keys[w * 64 + __builtin_ctzll(bits)];
      closest_site[at] = site_of_rank(around, sites, word_first, rank_of_key(key));
      distance_sq_vox[at] = uint16_t(distance_sq_of_key(key));
    }
}

ISOSHELL_VECTOR_VERSIONS
void LeafSimd::reached(const Neighbourhood& around, const LeafMask* sites, const Ball& ball, LeafMask& out) {
  if (around.span == 3) return reached_within<3>(around, sites, ball, out);
  if (around.span == 5) return reached_within<5>(around, sites, ball, out);
  reached_within<7>(around, sites, ball, out);
}

}  // namespace isoshell
