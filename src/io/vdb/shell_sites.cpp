// The sites that a shell was made of, found again in it.
#include "io/vdb/shell_sites.h"

#include "core/copy_product.h"
#include "core/parallel_ranges.h"
#include "core/voxel_set.h"
#include "isoshell/io/vdb_file.h"
#include "voxel/leaf.h"

namespace isoshell {

SiteSet sites_of_shell(const Shell& of, const LatticeFrame& frame) {
  const OnHost<Shell> shell(of);
  const VoxelSetView view = shell->voxels.view();
  const int64_t leaves = shell->voxels.leaf_count();
  Buffer<LeafMask> mask(leaves);
  for_each_index(int64_t(0), leaves, [&](int64_t l) {
    LeafMask sites{};
    for_each_active(view, l, [&](int offset, int64_t i) {
      if (shell->distance_sq_vox[i] == 0) sites.word[offset >> 6] |= uint64_t(1) << (offset & 63);
    });
    mask[l] = sites;
  });
  const auto is_used = [&](int64_t l) {
    uint64_t any = 0;
    for (const uint64_t word : mask[l].word) any |= word;
    return any != 0;
  };
  int64_t used = 0;
  for (int64_t l = 0; l < leaves; ++l) used += is_used(l);
  SiteSet sites;
  sites.voxels.leaf_key = Buffer<uint64_t>(used);
  sites.voxels.mask = Buffer<LeafMask>(used);
  int64_t at = 0;
  for (int64_t l = 0; l < leaves; ++l) {
    if (!is_used(l)) continue;
    sites.voxels.leaf_key[at] = view.leaf_key[l];
    sites.voxels.mask[at++] = mask[l];
  }
  index_host_leaves(sites.voxels, frame.extent_vox);
  return sites;
}

Buffer<Voxel> list_voxels(const VoxelSet& voxels) {
  const VoxelSetView view = voxels.view();
  Buffer<Voxel> list(voxels.voxel_count());
  for_each_index(int64_t(0), voxels.leaf_count(), [&](int64_t l) {
    const Voxel leaf = leaf_of_key(view.leaf_key[l]);
    for_each_active(view, l, [&](int offset, int64_t i) { list[i] = voxel_at(leaf, offset); });
  });
  return list;
}

}  // namespace isoshell
