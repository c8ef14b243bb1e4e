// Index of a VoxelSet: prefix sums of the masks and the two-level leaf lookup.
#include "core/voxel_set.h"

#include <algorithm>

#include "voxel/leaf.h"

namespace isoshell {

void index_leaves(VoxelSet& set, const int32_t extent_vox[3]) {
  const int64_t leaves = set.leaf_key.size();
  set.first = Buffer<int64_t>(leaves + 1);
  set.first[0] = 0;
  int64_t blocks = 0;
  for (int64_t l = 0; l < leaves; ++l) {
    int count = 0;
    for (uint64_t w : set.mask[l].word) count += popcount64(w);
    set.first[l + 1] = set.first[l] + count;
    blocks += l == 0 || set.leaf_key[l] >> 12 != set.leaf_key[l - 1] >> 12;
  }
  for (int axis = 0; axis < 3; ++axis) set.block_dims[axis] = (extent_vox[axis] + 127) / 128;
  set.block_table = Buffer<uint32_t>(int64_t(set.block_dims[0]) * set.block_dims[1] * set.block_dims[2]);
  std::fill(set.block_table.begin(), set.block_table.end(), kNone);
  set.blocks = Buffer<LeafBlock>(blocks);
  int64_t b = -1;
  for (int64_t l = 0; l < leaves; ++l) {
    const uint64_t key = set.leaf_key[l];
    if (l == 0 || key >> 12 != set.leaf_key[l - 1] >> 12) {
      set.blocks[++b] = LeafBlock{};
      set.blocks[b].first_leaf = uint32_t(l);
      const Voxel leaf = leaf_of_key(key);
      set.block_table[(int64_t(leaf.x >> 4) * set.block_dims[1] + (leaf.y >> 4)) * set.block_dims[2] + (leaf.z >> 4)] =
          uint32_t(b);
    }
    set.blocks[b].word[(key & 4095) >> 6] |= uint64_t(1) << (key & 63);
  }
  for (LeafBlock& block : set.blocks) {
    int before = 0;
    for (int w = 0; w < 64; ++w) {
      block.before[w] = uint16_t(before);
      before += popcount64(block.word[w]);
    }
  }
}

}  // namespace isoshell
