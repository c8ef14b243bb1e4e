// Index of a VoxelSet: prefix sums of the masks and the two-level leaf lookup.
#include "core/voxel_set.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <vector>

#include "voxel/leaf.h"

namespace isoshell {
namespace {

/// Number of the leaf that starts each block, then the number of leaves.
std::vector<int64_t> block_starts(const Buffer<uint64_t>& leaf_key) {
  std::vector<int64_t> starts;
  for (int64_t l = 0; l < leaf_key.size(); ++l)
    if (l == 0 || leaf_key[l] >> 12 != leaf_key[l - 1] >> 12) starts.push_back(l);
  starts.push_back(leaf_key.size());
  return starts;
}

LeafBlock block_of(const uint64_t* key, int64_t first, int64_t end) {
  LeafBlock block = {};
  block.first_leaf = uint32_t(first);
  for (int64_t l = first; l < end; ++l) block.word[(key[l] & 4095) >> 6] |= uint64_t(1) << (key[l] & 63);
  int before = 0;
  for (int w = 0; w < 64; ++w) {
    block.before[w] = uint16_t(before);
    before += popcount64(block.word[w]);
  }
  return block;
}

}  // namespace

void index_leaves(VoxelSet& set, const int32_t extent_vox[3]) {
  const int64_t leaves = set.leaf_key.size();
  set.first = Buffer<int64_t>(leaves + 1);
  set.first[0] = 0;
  tbb::parallel_for(int64_t(0), leaves, [&](int64_t l) {
    int count = 0;
    for (uint64_t w : set.mask[l].word) count += popcount64(w);
    set.first[l + 1] = count;
  });
  for (int64_t l = 0; l < leaves; ++l) set.first[l + 1] += set.first[l];

  for (int axis = 0; axis < 3; ++axis) set.block_dims[axis] = (extent_vox[axis] + 127) / 128;
  set.block_table = Buffer<uint32_t>(int64_t(set.block_dims[0]) * set.block_dims[1] * set.block_dims[2]);
  std::fill(set.block_table.begin(), set.block_table.end(), kNone);
  const std::vector<int64_t> starts = block_starts(set.leaf_key);
  set.blocks = Buffer<LeafBlock>(int64_t(starts.size()) - 1);
  tbb::parallel_for(int64_t(0), set.blocks.size(), [&](int64_t b) {
    const int64_t first = starts[size_t(b)];
    set.blocks[b] = block_of(set.leaf_key.data(), first, starts[size_t(b) + 1]);
    const Voxel leaf = leaf_of_key(set.leaf_key[first]);
    set.block_table[(int64_t(leaf.x >> 4) * set.block_dims[1] + (leaf.y >> 4)) * set.block_dims[2] + (leaf.z >> 4)] =
        uint32_t(b);
  });
}

}  // namespace isoshell
