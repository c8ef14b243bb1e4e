// Closest sites around one leaf: the neighbouring leaves, their order, and keys whose minimum is the closest site.
#pragma once

#include <cstdint>

#include "voxel/leaf.h"

namespace isoshell {

/// Leaves on either side of a leaf that a band reaches into: 1 to 3.
ISOSHELL_HD constexpr int reach_leaves(int band_vox) { return (band_vox + 7) >> 3; }

// A key is squared distance << kRankBits | rank, where the rank orders the voxels around one leaf exactly as site ids
// do: place of the voxel's leaf among the neighbours in canonical order, then offset in leaf. So the smallest key is
// the smallest (squared distance, site id), and it fits 32 bits: 343 * 512 < 2^18 ranks; distances of voxels that meet
// in a leaf's window are at most 27 an axis, 3 * 27^2 < 2^12.
constexpr int kRankBits = 18;
constexpr uint32_t kNoKey =
    uint32_t(1) << 31;  ///< larger than every key, and still so when a squared distance is added

ISOSHELL_HD constexpr uint32_t key_of_distance_sq(int distance_sq_vox) {
  return uint32_t(distance_sq_vox) << kRankBits;
}
ISOSHELL_HD inline int distance_sq_of_key(uint32_t key) { return int(key >> kRankBits); }
ISOSHELL_HD inline int rank_of_key(uint32_t key) { return int(key & ((1u << kRankBits) - 1)); }

/// The cube of leaves around a leaf that its band reaches, as the band's passes see it.
struct Neighbourhood {
  static constexpr int kMaxSpan = 7;
  static constexpr int kMaxLeaves = kMaxSpan * kMaxSpan * kMaxSpan;

  int span;                       ///< leaves per axis
  uint32_t leaf[kMaxLeaves];      ///< x-major: number of the leaf in the set, or kNone
  uint16_t place[kMaxLeaves];     ///< x-major: place in canonical order among the cube's leaves
  uint32_t by_place[kMaxLeaves];  ///< the inverse: number of the leaf at a place

  ISOSHELL_HD int at(int x, int y, int z) const { return (x * span + y) * span + z; }
};

namespace neighbourhood_detail {

/// Leaves of a window before the next node border; nodes are 16 leaves wide and a window is shorter than that.
ISOSHELL_HD inline int before_border(int32_t from, int span) {
  const int left = 16 - (from & 15);
  return left < span ? left : span;
}

/// Part 0 lies before the border, part 1 behind it.
struct Part {
  uint64_t key;
  int lo[3], hi[3];
};

}  // namespace neighbourhood_detail

/// Fills the places: within a node the canonical order is lexicographic, and nodes follow each other by their own keys.
ISOSHELL_HD inline void order_neighbours(Neighbourhood& around, Voxel first_leaf) {
  using namespace neighbourhood_detail;
  const int32_t from[3] = {first_leaf.x, first_leaf.y, first_leaf.z};
  int border[3];
  for (int axis = 0; axis < 3; ++axis) border[axis] = before_border(from[axis], around.span);
  Part parts[8];
  int count = 0;
  for (int p = 0; p < 8; ++p) {
    Part part;
    bool some = true;
    for (int axis = 0; axis < 3; ++axis) {
      const bool behind = p >> (2 - axis) & 1;
      part.lo[axis] = behind ? border[axis] : 0;
      part.hi[axis] = behind ? around.span : border[axis];
      some = some && part.lo[axis] < part.hi[axis];
    }
    if (!some) continue;
    // Shifted by whole root tiles so that windows that stick out of the lattice at 0 keep the order, too.
    part.key = leaf_key({from[0] + part.lo[0] + 512, from[1] + part.lo[1] + 512, from[2] + part.lo[2] + 512}) >> 12;
    int at = count++;
    for (; at > 0 && parts[at - 1].key > part.key; --at) parts[at] = parts[at - 1];
    parts[at] = part;
  }
  int place = 0;
  for (int p = 0; p < count; ++p)
    for (int x = parts[p].lo[0]; x < parts[p].hi[0]; ++x)
      for (int y = parts[p].lo[1]; y < parts[p].hi[1]; ++y)
        for (int z = parts[p].lo[2]; z < parts[p].hi[2]; ++z, ++place) {
          const int i = around.at(x, y, z);
          around.place[i] = uint16_t(place);
          around.by_place[place] = around.leaf[i];
        }
}

/// Finds the leaves within `reach` of `centre` in the set. Returns false when there is none.
ISOSHELL_HD inline bool find_neighbours(Neighbourhood& around, const VoxelSetView& set, Voxel centre, int reach) {
  around.span = 2 * reach + 1;
  bool some = false;
  int i = 0;
  for (int x = -reach; x <= reach; ++x)
    for (int y = -reach; y <= reach; ++y)
      for (int z = -reach; z <= reach; ++z, ++i) {
        around.leaf[i] = find_leaf(set, {centre.x + x, centre.y + y, centre.z + z});
        some = some || around.leaf[i] != kNone;
      }
  return some;
}

/// Site id of the voxel with this rank: the closest site itself. `word_first` holds the site id of the first voxel of
/// every mask word.
ISOSHELL_HD inline uint32_t site_of_rank(const Neighbourhood& around, const LeafMask* masks, const uint32_t* word_first,
                                         int rank) {
  const uint32_t leaf = around.by_place[rank >> 9];
  const int word = rank >> 6 & 7;
  const uint64_t below = (uint64_t(1) << (rank & 63)) - 1;
  return word_first[int64_t(leaf) * 8 + word] + uint32_t(popcount64(masks[leaf].word[word] & below));
}

/// Half-lengths along the third axis of a ball of lattice points.
struct Ball {
  int32_t radius;
  int8_t half[kMaxBandVox + 1][kMaxBandVox + 1];  ///< by |dx|, |dy|; -1 outside
};
ISOSHELL_HD inline Ball ball_of_radius(int radius_vox) {
  Ball ball;
  ball.radius = radius_vox;
  for (int x = 0; x <= radius_vox; ++x)
    for (int y = 0; y <= radius_vox; ++y) {
      int half = -1;
      while (x * x + y * y + (half + 1) * (half + 1) <= radius_vox * radius_vox) ++half;
      ball.half[x][y] = int8_t(half);
    }
  return ball;
}

}  // namespace isoshell
