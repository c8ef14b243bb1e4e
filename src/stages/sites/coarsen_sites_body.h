// coarsen_sites (see stages.h), written once over an executor.
#pragma once

#include "isoshell/advanced/stages.h"
#include "stages/sparse/drop_empty_leaves.h"

namespace isoshell {
namespace coarsening {

ISOSHELL_HD inline uint64_t parent_key(uint64_t key) {
  const Voxel l = leaf_of_key(key);
  return leaf_key({l.x >> 1, l.y >> 1, l.z >> 1});
}

/// The 64 voxels of twice the edge in a leaf; bit 16 x + 4 y + z.
ISOSHELL_HD inline uint64_t halved(const LeafMask& mask) {
  uint64_t out = 0;
  for (int x = 0; x < 4; ++x) {
    uint64_t w = mask.word[2 * x] | mask.word[2 * x + 1];
    w |= w >> 8;
    w |= w >> 1;
    for (int y = 0; y < 4; ++y)
      for (int z = 0; z < 4; ++z) out |= (w >> (16 * y + 2 * z) & 1) << (16 * x + 4 * y + z);
  }
  return out;
}

struct FindParent {
  View<const uint64_t> key;
  View<uint64_t> parent;
  ISOSHELL_HD void operator()(int64_t i) const { parent[i] = parent_key(key[i]); }
};

struct IsFirst {
  View<const uint64_t> key;
  ISOSHELL_HD bool operator()(int64_t i) const { return i == 0 || key[i] != key[i - 1]; }
};

struct TakeKey {
  View<const uint32_t> kept;
  View<const uint64_t> from;
  View<uint64_t> to;
  ISOSHELL_HD void operator()(int64_t i) const { to[i] = from[kept[i]]; }
};

/// Gathers a coarse leaf from the eight leaves that it covers.
struct GatherLeaf {
  VoxelSetView fine;
  View<const uint64_t> key;
  View<LeafMask> mask;
  ISOSHELL_HD void operator()(int64_t i) const {
    LeafMask out = {};
    const Voxel l = leaf_of_key(key[i]);
    for (int c = 0; c < 8; ++c) {
      const int dx = c >> 2, dy = c >> 1 & 1, dz = c & 1;
      const uint32_t leaf = find_leaf(fine, {2 * l.x + dx, 2 * l.y + dy, 2 * l.z + dz});
      if (leaf == kNone) continue;
      const uint64_t half = halved(fine.mask[leaf]);
      for (int x = 0; x < 4; ++x)
        for (int y = 0; y < 4; ++y)
          out.word[4 * dx + x] |= (half >> (16 * x + 4 * y) & 15) << (8 * (4 * dy + y) + 4 * dz);
    }
    mask[i] = out;
  }
};

struct HalveVoxel {
  View<const Voxel> fine;
  View<Voxel> coarse;
  ISOSHELL_HD void operator()(int64_t i) const { coarse[i] = {fine[i].x >> 1, fine[i].y >> 1, fine[i].z >> 1}; }
};

}  // namespace coarsening

template <class Exec>
SiteSet coarsen_sites_body(Exec& exec, const SiteSet& sites) {
  using namespace coarsening;
  const VoxelSetView fine = sites.voxels.view();
  Buffer<uint64_t> parent = exec.template make<uint64_t>(fine.leaf_key.size);
  exec.for_each("find parents", parent.size(), FindParent{fine.leaf_key, parent.view()});
  exec.sort(parent.view());
  const Buffer<uint32_t> kept = exec.select(parent.size(), IsFirst{parent.view()});
  SiteSet coarse;
  VoxelSet& set = coarse.voxels;
  set.leaf_key = exec.template make<uint64_t>(kept.size());
  set.mask = exec.template make<LeafMask>(kept.size());
  exec.for_each("take keys", kept.size(), TakeKey{kept.view(), parent.view(), set.leaf_key.view()});
  exec.for_each("gather leaves", kept.size(), GatherLeaf{fine, set.leaf_key.view(), set.mask.view()});
  int32_t extent_vox[3];
  for (int axis = 0; axis < 3; ++axis) extent_vox[axis] = (sites.voxels.block_dims[axis] + 1) / 2 * 128;
  index_leaves(exec, set, extent_vox);
  coarse.hollows = exec.template make<Voxel>(sites.hollows.size());
  exec.for_each("halve hollows", coarse.hollows.size(), HalveVoxel{sites.hollows.view(), coarse.hollows.view()});
  return coarse;
}

}  // namespace isoshell
