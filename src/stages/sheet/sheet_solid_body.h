// The solid that the sheet bounds, for the steps of build_sheet: leaves that its boundary may cross hold their voxels,
// every other leaf is wholly inside or wholly outside and is looked up in the outside. See sheet_closing_body.h.
#pragma once

#include "stages/sheet/sheet_flood_body.h"
#include "stages/sparse/drop_empty_leaves.h"

namespace isoshell {

/// Solid voxels of a leaf, or its one value for all 512.
struct SolidLeaf {
  const uint64_t* words;
  uint64_t uniform;
  ISOSHELL_HD uint64_t word(int x) const { return words ? words[x] : uniform; }
};

struct SolidView {
  VoxelSetView set;  ///< masks: solid voxels of the leaves that hold them
  OutsideView outside;

  ISOSHELL_HD SolidLeaf at(Voxel l) const {
    const uint32_t number = find_leaf(set, l);
    if (number != kNone) return {set.mask[number].word, 0};
    return {nullptr, ~outside.at(l).word[0]};
  }
};

/// Owner of a SolidView. Invariant: two voxels that share a corner and differ are never both in leaves without masks.
struct Solid {
  VoxelSet blocked;  ///< what the outside keeps away from, when it is not the sites themselves
  VoxelSet set;
  Outside outside;
  SolidView view() { return {set.view(), outside.view()}; }
};

/// A leaf with the voxels around it: row[x + 1][y + 1] has bit z + 1 for the voxels -1..8 of each axis.
struct SolidWindow {
  uint32_t row[10][10];
};
constexpr uint32_t kWindowRow = 0x3ff;  ///< all bits of a row

ISOSHELL_HD inline void load_window(const SolidView& solid, Voxel leaf, SolidWindow& window) {
  for (int dx = -1; dx <= 1; ++dx)
    for (int dy = -1; dy <= 1; ++dy) {
      const SolidLeaf below = solid.at({leaf.x + dx, leaf.y + dy, leaf.z - 1}),
                      here = solid.at({leaf.x + dx, leaf.y + dy, leaf.z}),
                      above = solid.at({leaf.x + dx, leaf.y + dy, leaf.z + 1});
      const int x0 = dx < 0 ? 7 : 0, x1 = dx > 0 ? 0 : 7, y0 = dy < 0 ? 7 : 0, y1 = dy > 0 ? 0 : 7;
      for (int x = x0; x <= x1; ++x) {
        const uint64_t b = below.word(x), h = here.word(x), a = above.word(x);
        for (int y = y0; y <= y1; ++y)
          window.row[dx * 8 + x + 1][dy * 8 + y + 1] =
              uint32_t((b >> (8 * y + 7) & 1) | (h >> (8 * y) & 255) << 1 | (a >> (8 * y) & 1) << 9);
      }
    }
}

/// Whether a window holds both solid and empty voxels.
ISOSHELL_HD inline bool is_mixed(const SolidWindow& window) {
  uint32_t any = 0, all = kWindowRow;
  for (const auto& layer : window.row)
    for (const uint32_t row : layer) {
      any |= row;
      all &= row;
    }
  return any != 0 && all != kWindowRow;
}

ISOSHELL_HD inline Voxel neighbour_leaf(Voxel l, int number) {
  return {l.x + number / 9 - 1, l.y + number / 3 % 3 - 1, l.z + number % 3 - 1};
}

namespace sheet_steps {

/// Which of the neighbours in bits of `wanted` have no mask yet.
ISOSHELL_HD inline uint32_t without_mask(const SolidView& solid, Voxel leaf, uint32_t wanted) {
  for (uint32_t bits = wanted; bits; bits &= bits - 1) {
    const int n = lowest_bit(bits);
    if (find_leaf(solid.set, neighbour_leaf(leaf, n)) != kNone) wanted &= ~(1u << n);
  }
  return wanted;
}

struct WantedBy {
  View<const uint32_t> wanted;
  ISOSHELL_HD int64_t operator()(int64_t i) const { return popcount64(wanted[i]); }
};

struct ListWanted {
  View<const uint64_t> old_key;
  View<const uint32_t> wanted;
  View<const int64_t> first;
  View<uint64_t> key;
  ISOSHELL_HD void operator()(int64_t i) const {
    key[i] = old_key[i];
    int64_t at = old_key.size + first[i];
    for (uint32_t bits = wanted[i]; bits; bits &= bits - 1)
      key[at++] = leaf_key(neighbour_leaf(leaf_of_key(old_key[i]), lowest_bit(bits)));
  }
};

struct IsFirstOfItsKey {
  View<const uint64_t> key;
  ISOSHELL_HD bool operator()(int64_t i) const { return i == 0 || key[i] != key[i - 1]; }
};

struct CopyMaskOrMakeUniform {
  SolidView solid;
  View<const uint32_t> kept;
  View<const uint64_t> from_key;
  View<uint64_t> key;
  View<LeafMask> mask;
  ISOSHELL_HD void operator()(int64_t i) const {
    key[i] = from_key[kept[i]];
    const SolidLeaf leaf = solid.at(leaf_of_key(key[i]));
    for (int x = 0; x < 8; ++x) mask[i].word[x] = leaf.word(x);
  }
};

/// Gives masks to the neighbours in the bits of `wanted`, per leaf; none may have one. Returns whether there were any.
template <class Exec>
bool give_masks(Exec& exec, Solid& solid, View<const uint32_t> wanted) {
  const SolidView old = solid.view();
  const int64_t leaves = old.set.leaf_key.size;
  Buffer<int64_t> first = exec.template make<int64_t>(leaves);
  const int64_t more = exec.exclusive_scan_of(leaves, WantedBy{wanted}, first.view());
  if (more == 0) return false;
  Buffer<uint64_t> key = exec.template make<uint64_t>(leaves + more);
  exec.for_each("list leaves", leaves, ListWanted{old.set.leaf_key, wanted, first.view(), key.view()});
  exec.sort(key.view());
  const Buffer<uint32_t> kept = exec.select(key.size(), IsFirstOfItsKey{key.view()});
  VoxelSet grown;
  grown.leaf_key = exec.template make<uint64_t>(kept.size());
  grown.mask = exec.template make<LeafMask>(kept.size());
  exec.for_each("masks", kept.size(),
                CopyMaskOrMakeUniform{old, kept.view(), key.view(), grown.leaf_key.view(), grown.mask.view()});
  index_leaves(exec, grown, BlockExtent(old.set).vox);
  solid.set = std::move(grown);
  return true;
}

}  // namespace sheet_steps
}  // namespace isoshell
