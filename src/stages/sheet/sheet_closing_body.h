// The part of build_sheet that closes the sites by r: the solid is what the outside does not reach when it keeps
// farther than r from the sites and is then thickened by r.
#pragma once

#include "isoshell/advanced/stages.h"
#include "stages/sheet/sheet_solid_body.h"

namespace isoshell {
namespace sheet_steps {

/// Solid voxels of the leaves that hold walls.
struct ComplementOfOutside {
  OutsideView out;
  View<uint64_t> key;
  View<LeafMask> solid;
  ISOSHELL_HD void operator()(int64_t i) const {
    key[i] = out.blocked.leaf_key[i];
    for (int x = 0; x < 8; ++x) solid[i].word[x] = ~out.leaf[i].word[x];
  }
};

/// Outside voxels of a leaf that share a face with a blocked voxel.
ISOSHELL_HD inline LeafMask outside_rim(const OutsideView& out, Voxel l) {
  LeafMask rim = {};
  const uint32_t number = find_leaf(out.blocked, l);
  if (number != kNone) {
    const LeafMask& m = out.blocked.mask[number];
    for (int x = 0; x < 8; ++x) {
      const uint64_t w = m.word[x];
      rim.word[x] |= (w << 1 & ~kLowZ) | (w >> 1 & ~kHighZ) | w << 8 | w >> 8;
      if (x > 0) rim.word[x] |= m.word[x - 1];
      if (x < 7) rim.word[x] |= m.word[x + 1];
    }
  }
  for (int face = 0; face < 6; ++face) {
    const uint32_t from = find_leaf(out.blocked, step_through(l, face));
    if (from == kNone) continue;
    const LeafMask in = crossing(out.blocked.mask[from], face ^ 1);
    for (int x = 0; x < 8; ++x) rim.word[x] |= in.word[x];
  }
  const LeafMask outside = out.at(l);
  for (int x = 0; x < 8; ++x) rim.word[x] &= outside.word[x];
  return rim;
}

struct ListLeafAndNeighbours {
  OutsideView out;
  View<uint64_t> key;
  ISOSHELL_HD void operator()(int64_t i) const {
    const uint64_t own = out.blocked.leaf_key[i];
    key[7 * i] = own;
    for (int face = 0; face < 6; ++face) {
      const Voxel n = step_through(leaf_of_key(own), face);
      key[7 * i + 1 + face] = out.table_index(n) < 0 ? own : leaf_key(n);
    }
  }
};

struct MarkRim {
  OutsideView out;
  View<const uint32_t> kept;
  View<const uint64_t> from_key;
  View<uint64_t> key;
  View<LeafMask> mask;
  ISOSHELL_HD void operator()(int64_t i) const {
    key[i] = from_key[kept[i]];
    mask[i] = outside_rim(out, leaf_of_key(key[i]));
  }
};

/// The outside voxels that share a face with a voxel which is not outside.
template <class Exec>
SiteSet rim_of_outside(Exec& exec, const OutsideView& out) {
  const VoxelSetView& blocked = out.blocked;
  Buffer<uint64_t> near = exec.template make<uint64_t>(blocked.leaf_key.size * 7);
  exec.for_each("leaves around", blocked.leaf_key.size, ListLeafAndNeighbours{out, near.view()});
  exec.sort(near.view());
  const Buffer<uint32_t> kept = exec.select(near.size(), IsFirstOfItsKey{near.view()});
  Buffer<uint64_t> key = exec.template make<uint64_t>(kept.size());
  Buffer<LeafMask> mask = exec.template make<LeafMask>(kept.size());
  exec.for_each("rim of the outside", kept.size(), MarkRim{out, kept.view(), near.view(), key.view(), mask.view()});
  return {voxel_set_of(exec, key.view(), mask.view(), BlockExtent(blocked).vox)};
}

/// Solid voxels of the leaves within reach of the outside's rim: neither outside nor within r of it.
struct RemoveThickenedOutside {
  OutsideView out;
  View<const uint64_t> key;
  View<LeafMask> mask;  ///< in: voxels within r of the rim
  ISOSHELL_HD void operator()(int64_t i) const {
    const LeafMask outside = out.at(leaf_of_key(key[i]));
    for (int x = 0; x < 8; ++x) mask[i].word[x] = ~(mask[i].word[x] | outside.word[x]);
  }
};

/// Neighbours wholly inside that show a face to an empty voxel of the leaf.
struct WantInsideNeighbours {
  SolidView solid;
  View<uint32_t> wanted;
  ISOSHELL_HD void operator()(int64_t i) const {
    const Voxel l = leaf_of_key(solid.set.leaf_key[i]);
    uint32_t want = 0;
    LeafMask empty;
    for (int x = 0; x < 8; ++x) empty.word[x] = ~solid.set.mask[i].word[x];
    for (int face = 0; face < 6; ++face) {
      const LeafMask facing = crossing(empty, face);
      uint64_t any = 0;
      for (const uint64_t w : facing.word) any |= w;
      const Voxel n = step_through(l, face);
      if (any && solid.at(n).word(0)) want |= 1u << neighbour_number(n.x - l.x, n.y - l.y, n.z - l.z);
    }
    wanted[i] = without_mask(solid, l, want);
  }
};

/// The solid of every voxel that is not outside of `walls`, which must stay where it is as long as the solid lives.
template <class Exec>
Solid complement_of_outside(Exec& exec, const VoxelSetView& barrier, View<const Voxel> hollows) {
  Solid solid;
  solid.outside = Exec::Kernels::FindOutside::run(exec, barrier, hollows);
  solid.set.leaf_key = exec.template make<uint64_t>(barrier.leaf_key.size);
  solid.set.mask = exec.template make<LeafMask>(barrier.leaf_key.size);
  exec.for_each("solid", barrier.leaf_key.size,
                ComplementOfOutside{solid.outside.view(), solid.set.leaf_key.view(), solid.set.mask.view()});
  index_leaves(exec, solid.set, BlockExtent(barrier).vox);
  return solid;
}

struct IsEmptyVoxel {
  SolidView solid;
  View<const Voxel> voxels;
  ISOSHELL_HD bool operator()(int64_t i) const {
    const Voxel v = voxels[i];
    const uint64_t word = solid.at(leaf_of_voxel(v)).word(v.x & 7);
    return (word >> (offset_in_leaf(v) & 63) & 1) == 0;
  }
};
struct CopyKeptVoxel {
  View<const uint32_t> kept;
  View<const Voxel> from;
  View<Voxel> to;
  ISOSHELL_HD void operator()(int64_t i) const { to[i] = from[kept[i]]; }
};
/// Those of `voxels` that the solid leaves empty.
template <class Exec>
Buffer<Voxel> empty_voxels(Exec& exec, const SolidView& solid, View<const Voxel> voxels) {
  const Buffer<uint32_t> kept = exec.select(voxels.size, IsEmptyVoxel{solid, voxels});
  Buffer<Voxel> empty = exec.template make<Voxel>(kept.size());
  exec.for_each("copy empty voxels", kept.size(), CopyKeptVoxel{kept.view(), voxels, empty.view()});
  return empty;
}

}  // namespace sheet_steps

/// Result: with outside(r) the voxels that a path of face neighbours, all farther than r from every site (centre to
/// centre), joins to the border or a hollow, the solid is every voxel farther than r from outside(r). r = 0: every
/// voxel that is not outside. The solid holds all sites; holes up to 2 r voxels wide close. Sites keep 2 r + 1 voxels
/// off the border. Cost: r > 0 builds two shells of thickness r by the set's BuildShell, so peak memory grows with r.
template <class Exec>
Solid close_sites(Exec& exec, const SiteSet& sites, int32_t closing_vox) {
  using namespace sheet_steps;
  const VoxelSetView site_view = sites.voxels.view();
  if (closing_vox == 0) return complement_of_outside(exec, site_view, sites.hollows.view());
  Solid solid;
  const ShellOptions band{closing_vox};
  solid.blocked = Exec::Kernels::BuildShell::run(exec, sites, band).voxels;
  solid.outside = Exec::Kernels::FindOutside::run(exec, solid.blocked.view(), sites.hollows.view());
  // The voxel of the outside nearest to any other voxel is one of its rim: a step towards that voxel leaves the
  // outside.
  solid.set = Exec::Kernels::BuildShell::run(exec, rim_of_outside(exec, solid.outside.view()), band).voxels;
  exec.for_each("remove the thickened outside", solid.set.leaf_count(),
                RemoveThickenedOutside{solid.outside.view(), solid.set.leaf_key.view(), solid.set.mask.view()});
  index_leaves(exec, solid.set, BlockExtent(site_view).vox);
  // Where the thickened outside ends on a leaf's border, the solid beyond shows faces too.
  Buffer<uint32_t> wanted = exec.template make<uint32_t>(solid.set.leaf_count());
  exec.for_each("leaves inside", wanted.size(), WantInsideNeighbours{solid.view(), wanted.view()});
  give_masks(exec, solid, wanted.view());
  return solid;
}

/// Adds every voxel that the solid encloses outside of hollows. A well-composed solid stays so: only whole components
/// of its boundary go. A hollow that the solid fills is left out: leaves wholly inside have no walls, and the outside
/// would spread through them.
template <class Exec>
void fill_cavities(Exec& exec, Solid& solid, View<const Voxel> hollows = {}) {
  const Buffer<Voxel> open = sheet_steps::empty_voxels(exec, solid.view(), hollows);
  VoxelSet barrier = std::move(solid.set);
  solid = sheet_steps::complement_of_outside(exec, barrier.view(), View<const Voxel>(open.view()));
  solid.blocked = std::move(barrier);
}

}  // namespace isoshell
