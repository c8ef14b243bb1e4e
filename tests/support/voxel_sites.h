// Site sets straight from voxels, for stages that need no surface.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "core/voxel_set.h"
#include "isoshell/advanced/site_set.h"
#include "voxel/leaf.h"

namespace isoshell {

using Extent = std::array<int32_t, 3>;  ///< lattice size in voxels

/// Site set of exactly these voxels, in any order, repeated or not.
inline SiteSet make_site_set(const std::vector<Voxel>& voxels, Extent extent) {
  std::vector<uint64_t> code;
  code.reserve(voxels.size());
  for (Voxel v : voxels) code.push_back(leaf_key(leaf_of_voxel(v)) << 9 | uint64_t(offset_in_leaf(v)));
  std::sort(code.begin(), code.end());
  int64_t leaves = 0;
  for (size_t i = 0; i < code.size(); ++i) leaves += i == 0 || code[i] >> 9 != code[i - 1] >> 9;
  SiteSet sites;
  sites.voxels.leaf_key = Buffer<uint64_t>(leaves);
  sites.voxels.mask = Buffer<LeafMask>(leaves);
  int64_t leaf = -1;
  for (size_t i = 0; i < code.size(); ++i) {
    if (i == 0 || code[i] >> 9 != code[i - 1] >> 9) {
      sites.voxels.leaf_key[++leaf] = code[i] >> 9;
      sites.voxels.mask[leaf] = LeafMask{};
    }
    sites.voxels.mask[leaf].word[code[i] >> 6 & 7] |= uint64_t(1) << (code[i] & 63);
  }
  index_host_leaves(sites.voxels, extent.data());
  return sites;
}

/// All active voxels in canonical order.
inline std::vector<Voxel> voxels_of(const VoxelSet& set) {
  std::vector<Voxel> out;
  out.reserve(size_t(set.voxel_count()));
  const VoxelSetView view = set.view();
  for (int64_t l = 0; l < set.leaf_count(); ++l)
    for_each_active(view, l,
                    [&](int offset, int64_t) { out.push_back(voxel_at(leaf_of_key(set.leaf_key[l]), offset)); });
  return out;
}

}  // namespace isoshell
