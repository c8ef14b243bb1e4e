// The part of build_sheet that makes the solid well-composed, so that the faces between solid and empty voxels form a
// closed 2-manifold: at every lattice edge two of them meet or none, at every lattice corner one fan or none.
#pragma once

#include "stages/sheet/sheet_solid_body.h"

namespace isoshell {

/// Voxels to add, rows as in SolidWindow.
struct WindowAdditions {
  uint32_t row[10][10];
};

/// What one round adds for the configurations that lie wholly in the window. Axes come in the order x, y, z.
/// Square of four voxels, two opposite solid and two opposite empty: the empty one with the smaller coordinates
/// (smaller first axis of the square). Cube of eight: only two opposite corners p, q solid (p.x < q.x): (q.x, p.y, p.z)
/// and (q.x, q.y, p.z), which join them by faces. Only two opposite corners empty: the one with the smaller x.
/// `add(x, y, bits)` adds to row (x, y); this finds what the configurations with their smallest row at (x, y) ask for.
template <class Add>
ISOSHELL_HD inline void find_additions_at(const SolidWindow& window, int x, int y, Add add) {
  constexpr uint32_t kPairs = kWindowRow >> 1;  // rows of voxels z that have a z + 1
  const uint32_t a = window.row[x][y];
  uint32_t here = 0;
  if (x < 9) {  // squares in x and z
    const uint32_t c = window.row[x + 1][y];
    here |= (a & ~(a >> 1) & ~c & (c >> 1) & kPairs) << 1;
    here |= ~a & (a >> 1) & c & ~(c >> 1) & kPairs;
  }
  if (y < 9) {  // squares in y and z
    const uint32_t b = window.row[x][y + 1];
    here |= (a & ~(a >> 1) & ~b & (b >> 1) & kPairs) << 1;
    here |= ~a & (a >> 1) & b & ~(b >> 1) & kPairs;
  }
  add(x, y, here);
  if (x == 9 || y == 9) return;
  const uint32_t b = window.row[x][y + 1], c = window.row[x + 1][y], d = window.row[x + 1][y + 1];
  add(x, y + 1, a & ~b & ~c & d);  // squares in x and y
  add(x, y, ~a & b & c & ~d & kWindowRow);
  // Cubes: bit i of corner[4 x + 2 y + z]; opposite corners sum to 7.
  const uint32_t corner[8] = {a, a >> 1, b, b >> 1, c, c >> 1, d, d >> 1};
  for (int p = 0; p < 4; ++p) {
    uint32_t any = 0, all = kPairs;
    for (int o = 0; o < 8; ++o)
      if (o != p && o != 7 - p) {
        any |= corner[o];
        all &= corner[o];
      }
    const uint32_t joined = corner[p] & corner[7 - p] & ~any & kPairs, opened = ~corner[p] & ~corner[7 - p] & all;
    const int py = p >> 1, pz = p & 1;
    add(x + 1, y + py, joined << pz);
    add(x + 1, y + 1 - py, joined << pz);
    add(x, y + py, opened << pz);
  }
}

ISOSHELL_HD inline void find_additions(const SolidWindow& window, WindowAdditions& add) {
  for (auto& layer : add.row)
    for (uint32_t& row : layer) row = 0;
  for (int x = 0; x < 10; ++x)
    for (int y = 0; y < 10; ++y)
      find_additions_at(window, x, y, [&](int to_x, int to_y, uint32_t bits) { add.row[to_x][to_y] |= bits; });
}

namespace sheet_steps {

/// Voxels that a round adds to the leaves in `list`, and neighbours without mask that it would add to.
struct FindAdditions {
  SolidView solid;
  View<const uint32_t> list;
  View<LeafMask> added;   ///< per entry of the list
  View<uint32_t> wanted;  ///< per leaf
  ISOSHELL_HD void operator()(int64_t i) const {
    added[i] = LeafMask{};
    const Voxel l = leaf_of_key(solid.set.leaf_key[list[i]]);
    SolidWindow window;
    load_window(solid, l, window);
    if (!is_mixed(window)) return;
    WindowAdditions add;
    find_additions(window, add);
    uint32_t reached = 0;
    for (int x = 0; x < 10; ++x)
      for (int y = 0; y < 10; ++y) {
        const uint32_t row = add.row[x][y];
        if (!row) continue;
        const int dx = (x + 7) / 8 - 1, dy = (y + 7) / 8 - 1;
        if (dx == 0 && dy == 0) added[i].word[x - 1] |= uint64_t(row >> 1 & 255) << (8 * (y - 1));
        if (row & 1) reached |= 1u << neighbour_number(dx, dy, -1);
        if (row & 0x1fe) reached |= 1u << neighbour_number(dx, dy, 0);
        if (row >> 9) reached |= 1u << neighbour_number(dx, dy, 1);
      }
    if (reached) wanted[list[i]] = without_mask(solid, l, reached);
  }
};

struct AddVoxels {
  SolidView solid;
  View<const uint32_t> list;
  View<const LeafMask> added;
  View<LeafMask> mask;
  View<uint32_t> look_again;  ///< per leaf
  ISOSHELL_HD void operator()(int64_t i) const {
    uint64_t any = 0;
    for (int x = 0; x < 8; ++x) {
      any |= added[i].word[x];
      mask[list[i]].word[x] |= added[i].word[x];
    }
    if (!any) return;
    const Voxel l = leaf_of_key(solid.set.leaf_key[list[i]]);
    for (int n = 0; n < 27; ++n) {
      const uint32_t leaf = find_leaf(solid.set, neighbour_leaf(l, n));
      if (leaf != kNone) atomic_or(look_again[leaf], 1u);
    }
  }
};

struct IsSet {
  View<const uint32_t> flag;
  ISOSHELL_HD bool operator()(int64_t i) const { return flag[i] != 0; }
};

struct VoxelsIn {
  View<const LeafMask> mask;
  ISOSHELL_HD int64_t operator()(int64_t i) const { return voxels_in(mask[i]); }
};

}  // namespace sheet_steps

/// Result: the solid after as many synchronous rounds of find_additions, over all windows at once, as change something.
/// It ends: only voxels in the box around the solid are ever added. Returns the number of voxels added.
template <class Exec>
int64_t make_well_composed(Exec& exec, Solid& solid) {
  using namespace sheet_steps;
  int64_t total = 0;
  Buffer<uint32_t> look = exec.template make<uint32_t>(solid.set.leaf_count());
  exec.fill(look.view(), 1u);
  for (;;) {
    const Buffer<uint32_t> list = exec.select(look.size(), IsSet{look.view()});
    if (list.empty()) break;
    Buffer<LeafMask> added = exec.template make<LeafMask>(list.size());
    Buffer<uint32_t> wanted = exec.template make<uint32_t>(solid.set.leaf_count());
    exec.fill(wanted.view(), 0u);
    exec.for_each("find additions", list.size(), FindAdditions{solid.view(), list.view(), added.view(), wanted.view()});
    if (give_masks(exec, solid, wanted.view())) {  // the same round again, with room for all it adds
      look = exec.template make<uint32_t>(solid.set.leaf_count());
      exec.fill(look.view(), 1u);
      continue;
    }
    total += exec.sum(added.size(), VoxelsIn{added.view()});
    exec.fill(look.view(), 0u);
    exec.for_each("add voxels", list.size(),
                  AddVoxels{solid.view(), list.view(), added.view(), solid.set.mask.view(), look.view()});
  }
  const BlockExtent extent(solid.set.view());
  index_leaves(exec, solid.set, extent.vox);
  return total;
}

}  // namespace isoshell
