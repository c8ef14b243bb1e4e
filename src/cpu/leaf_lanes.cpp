// Separable passes of the banded distance transform over one leaf (paper section 3.1): z from the bitmap, then y, then
// x. A row of eight voxels along z is one vector; the compiler makes versions for machines with and without wide
// vectors.
#include "cpu/leaf_lanes.h"

#include <cstring>

#if defined(__x86_64__) && defined(__linux__) && defined(__GNUC__) && !defined(__clang__) && __GNUC__ >= 12 && \
    !defined(__SANITIZE_THREAD__) && !defined(__SANITIZE_ADDRESS__)
#define ISOSHELL_VECTOR_VERSIONS __attribute__((target_clones("arch=x86-64-v3", "default")))
#else
#define ISOSHELL_VECTOR_VERSIONS
#endif
#define ISOSHELL_INLINE inline __attribute__((always_inline))

namespace isoshell {
namespace {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "rows of a mask word are read as bytes");

using Lanes = uint32_t __attribute__((vector_size(32)));

constexpr int kMaxRows = 8 + 2 * kMaxBandVox;  ///< rows of the halo of a leaf, per axis
constexpr int kMaxReach = 3;

/// Squared distances from the eight voxels of a row to a site `z` voxels from its first, and the same for all eight.
struct Tables {
  alignas(32) uint32_t along[8 * (2 * kMaxReach + 1)][8];
  alignas(32) uint32_t across[kMaxRows][8];
};
constexpr Tables make_tables() {
  Tables t{};
  for (int s = 0; s < 8 * (2 * kMaxReach + 1); ++s)
    for (int z = 0; z < 8; ++z) t.along[s][z] = key_of_distance_sq((s - 8 * kMaxReach - z) * (s - 8 * kMaxReach - z));
  for (int d = 0; d < kMaxRows; ++d)
    for (int z = 0; z < 8; ++z) t.across[d][z] = key_of_distance_sq(d * d);
  return t;
}
constexpr Tables kTables = make_tables();

ISOSHELL_INLINE void lower_to(Lanes& best, const Lanes& key) { best = key < best ? key : best; }
ISOSHELL_INLINE const Lanes& lanes(const uint32_t (&row)[8]) { return reinterpret_cast<const Lanes&>(row); }

/// The words of one plane of constant x of the cube of leaves, [y][z].
struct PlaneWords {
  uint64_t word[Neighbourhood::kMaxSpan][Neighbourhood::kMaxSpan];
};
ISOSHELL_INLINE bool gather_plane(const Neighbourhood& around, const LeafMask* sites, int x, PlaneWords& plane) {
  const uint32_t* leaf = &around.leaf[around.at(x >> 3, 0, 0)];
  uint64_t any = 0;
  for (int y = 0; y < around.span; ++y)
    for (int z = 0; z < around.span; ++z, ++leaf)
      any |= plane.word[y][z] = *leaf == kNone ? 0 : sites[*leaf].word[x & 7];
  return any != 0;
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
ISOSHELL_INLINE uint64_t pass_z(const Neighbourhood& around, const PlaneWords& plane, int x, int band, Lanes* rows) {
  const int middle = 8 * (around.span / 2), lowest = middle - band, count = 8 + 2 * band;
  const uint64_t window = ((uint64_t(1) << count) - 1) << lowest;
  const Lanes none = Lanes{} + kNoKey;
  uint64_t used = 0;
  for (int j = 0; j < count; ++j) {
    const int y = lowest + j;
    const uint64_t row = row_bits(plane.word[y >> 3], around.span, y & 7) & window;
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
  for (int j = from; j <= to; ++j) {
    const int distance = j - at - band;
    lower_to(best, in[j * stride] + lanes(kTables.across[distance < 0 ? -distance : distance]));
  }
}

}  // namespace

ISOSHELL_VECTOR_VERSIONS
void LeafLanes::closest(const Neighbourhood& around, const LeafMask* sites, int band_vox, uint32_t keys[512]) {
  const int lowest = 8 * (around.span / 2) - band_vox, count = 8 + 2 * band_vox;
  PlaneWords words;
  Lanes rows[kMaxRows], planes[kMaxRows * 8];
  const Lanes none = Lanes{} + kNoKey;
  int first = count, last = -1;
  for (int i = 0; i < count; ++i) {
    uint64_t used = 0;
    if (gather_plane(around, sites, lowest + i, words)) used = pass_z(around, words, lowest + i, band_vox, rows);
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

ISOSHELL_VECTOR_VERSIONS
void LeafLanes::reached(const Neighbourhood& around, const LeafMask* sites, const Ball& ball, LeafMask& out) {
  const int radius = ball.radius, middle = 8 * (around.span / 2), lowest = middle - radius, count = 8 + 2 * radius;
  PlaneWords words;
  // grown[w][j]: row j's voxels in the middle leaf that are at most w from a site of that row.
  uint8_t grown[kMaxBandVox + 1][kMaxRows];
  uint64_t rows[kMaxRows], spread[kMaxRows];
  for (uint64_t& word : out.word) word = 0;
  for (int i = 0; i < count; ++i) {
    if (!gather_plane(around, sites, lowest + i, words)) continue;
    uint64_t any = 0;
    for (int j = 0; j < count; ++j) {
      rows[j] = row_bits(words.word[(lowest + j) >> 3], around.span, (lowest + j) & 7);
      any |= spread[j] = rows[j];
      grown[0][j] = uint8_t(rows[j] >> middle);
    }
    if (!any) continue;
    const int outside = i < radius ? radius - i : i > radius + 7 ? i - radius - 7 : 0;
    for (int w = 1; w <= ball.half[outside][0]; ++w)
      for (int j = 0; j < count; ++j) {
        spread[j] |= rows[j] << w | rows[j] >> w;
        grown[w][j] = uint8_t(spread[j] >> middle);
      }
    for (int x = i > 2 * radius ? i - 2 * radius : 0; x < 8 && x <= i; ++x) {
      const int dx = i - radius - x < 0 ? x + radius - i : i - radius - x;
      for (int dy = -ball.half[dx][0]; dy <= ball.half[dx][0]; ++dy) {
        uint64_t eight_rows;
        std::memcpy(&eight_rows, &grown[ball.half[dx][dy < 0 ? -dy : dy]][radius + dy], 8);
        out.word[x] |= eight_rows;
      }
    }
  }
}

}  // namespace isoshell
