// Sets of leaves, and of voxels, from what says where they are: in bits, without a sort of more than blocks.
#pragma once

#include "stages/sparse/index_leaves.h"
#include "voxel/atomic.h"

namespace isoshell {
namespace marked_leaves {

struct BlockTable {
  int32_t dims[3];
  ISOSHELL_HD int64_t place(int x, int y, int z) const {
    return (int64_t(x >> 4) * dims[1] + (y >> 4)) * dims[2] + (z >> 4);
  }
};

template <class Runs>
struct MarkBlocks {
  BlockTable blocks;
  Runs runs;
  View<uint32_t> table;
  ISOSHELL_HD void operator()(int64_t i) const {
    runs(i, [this](int x, int y, int z0, int z1) {
      for (int z = z0 & ~15; z <= z1; z += 16) {
        uint32_t& mark = table[blocks.place(x, y, z)];
        if (!atomic_load(mark)) atomic_or(mark, 1u);
      }
    });
  }
};

struct IsMarked {
  View<const uint32_t> table;
  ISOSHELL_HD bool operator()(int64_t i) const { return table[i] != 0; }
};

struct KeyOfBlock {
  BlockTable blocks;
  View<const uint32_t> marked;
  View<uint64_t> key;
  ISOSHELL_HD void operator()(int64_t i) const {
    const int32_t z = int32_t(marked[i] % uint32_t(blocks.dims[2])), xy = int32_t(marked[i] / uint32_t(blocks.dims[2]));
    key[i] = leaf_key({xy / blocks.dims[1] * 16, xy % blocks.dims[1] * 16, z * 16}) >> 12;
  }
};

struct NumberBlock {
  BlockTable blocks;
  View<const uint64_t> key;
  View<uint32_t> table;
  ISOSHELL_HD void operator()(int64_t i) const {
    const Voxel leaf = leaf_of_key(key[i] << 12);
    table[blocks.place(leaf.x, leaf.y, leaf.z)] = uint32_t(i);
  }
};

/// Sets a bit per leaf, 64 words a block, in key order.
template <class Runs>
struct MarkLeaves {
  BlockTable blocks;
  Runs runs;
  View<const uint32_t> table;
  View<uint64_t> words;
  ISOSHELL_HD void operator()(int64_t i) const {
    runs(i, [this](int x, int y, int z0, int z1) {
      for (int z = z0 & ~15; z <= z1; z += 16) {
        const int lo = z0 > z ? z0 - z : 0, hi = z1 < z + 15 ? z1 - z : 15;
        const int bit = (x & 15) << 8 | (y & 15) << 4;
        const uint64_t run = ((uint64_t(2) << hi) - (uint64_t(1) << lo)) << (bit & 63);
        uint64_t& word = words[int64_t(table[blocks.place(x, y, z)]) * 64 + (bit >> 6)];
        if ((atomic_load(word) & run) != run) atomic_or(word, run);
      }
    });
  }
};

struct LeavesInWord {
  View<const uint64_t> words;
  ISOSHELL_HD int64_t operator()(int64_t i) const { return popcount64(words[i]); }
};

struct ListLeaves {
  View<const uint64_t> words, block_key;
  View<const int64_t> first;
  View<uint64_t> leaf_key;
  ISOSHELL_HD void operator()(int64_t i) const {
    int64_t at = first[i];
    for (uint64_t bits = words[i]; bits; bits &= bits - 1)
      leaf_key[at++] = block_key[i >> 6] << 12 | uint64_t((i & 63) << 6 | lowest_bit(bits));
  }
};

/// Finds the number of a leaf that was marked.
struct NumberOfLeaf {
  BlockTable blocks;
  View<const uint32_t> table;
  View<const uint64_t> words;
  View<const int64_t> first;
  ISOSHELL_HD int64_t operator()(Voxel leaf) const {
    const int bit = (leaf.x & 15) << 8 | (leaf.y & 15) << 4 | (leaf.z & 15);
    const int64_t word = int64_t(table[blocks.place(leaf.x, leaf.y, leaf.z)]) * 64 + (bit >> 6);
    return first[word] + popcount64(words[word] & ((uint64_t(1) << (bit & 63)) - 1));
  }
};

template <class VoxelOf>
struct LeafOfVoxel {
  VoxelOf voxel_of;
  template <class Run>
  ISOSHELL_HD void operator()(int64_t i, Run run) const {
    const Voxel leaf = leaf_of_voxel(voxel_of(i));
    run(leaf.x, leaf.y, leaf.z, leaf.z);
  }
};

template <class VoxelOf>
struct EnterVoxel {
  VoxelOf voxel_of;
  NumberOfLeaf number;
  View<LeafMask> mask;
  ISOSHELL_HD void operator()(int64_t i) const {
    const Voxel v = voxel_of(i);
    const int offset = offset_in_leaf(v);
    uint64_t& word = mask[number(leaf_of_voxel(v))].word[offset >> 6];
    const uint64_t bit = uint64_t(1) << (offset & 63);
    if (!(atomic_load(word) & bit)) atomic_or(word, bit);
  }
};

}  // namespace marked_leaves

/// Leaves that were marked, ascending, and the way to them.
struct MarkedLeaves {
  Buffer<uint64_t> leaf_key;
  Buffer<uint32_t> table;
  Buffer<uint64_t> words;
  Buffer<int64_t> first;
};

/// The leaves that `runs` names for 0 to count - 1: runs(i, run) calls run(x, y, first z, last z), leaf coordinates
/// within the lattice of so many blocks.
template <class Exec, class Runs>
MarkedLeaves mark_leaves(Exec& exec, const int32_t block_dims[3], int64_t count, Runs runs) {
  using namespace marked_leaves;
  const BlockTable blocks{{block_dims[0], block_dims[1], block_dims[2]}};
  MarkedLeaves made;
  made.table = exec.template make<uint32_t>(int64_t(block_dims[0]) * block_dims[1] * block_dims[2]);
  exec.fill(made.table.view(), 0u);
  exec.for_each("mark blocks", count, MarkBlocks<Runs>{blocks, runs, made.table.view()});
  const Buffer<uint32_t> marked = exec.select(made.table.size(), IsMarked{made.table.view()});
  Buffer<uint64_t> block_key = exec.template make<uint64_t>(marked.size());
  exec.for_each("block keys", marked.size(), KeyOfBlock{blocks, marked.view(), block_key.view()});
  exec.sort(block_key.view());
  exec.for_each("number blocks", marked.size(), NumberBlock{blocks, block_key.view(), made.table.view()});

  made.words = exec.template make<uint64_t>(marked.size() * 64);
  exec.fill(made.words.view(), uint64_t(0));
  exec.for_each("mark leaves", count, MarkLeaves<Runs>{blocks, runs, made.table.view(), made.words.view()});
  made.first = exec.template make<int64_t>(made.words.size());
  made.leaf_key = exec.template make<uint64_t>(
      exec.exclusive_scan_of(made.words.size(), LeavesInWord{made.words.view()}, made.first.view()));
  exec.for_each("list leaves", made.words.size(),
                ListLeaves{made.words.view(), block_key.view(), made.first.view(), made.leaf_key.view()});
  return made;
}

/// The set of the voxels voxel_of(0) to voxel_of(count - 1), which lie within the lattice and may repeat.
template <class Exec, class VoxelOf>
VoxelSet voxel_set_of_voxels(Exec& exec, const int32_t extent_vox[3], int64_t count, VoxelOf voxel_of) {
  using namespace marked_leaves;
  const BlockTable blocks{{(extent_vox[0] + 127) / 128, (extent_vox[1] + 127) / 128, (extent_vox[2] + 127) / 128}};
  MarkedLeaves leaves = mark_leaves(exec, blocks.dims, count, LeafOfVoxel<VoxelOf>{voxel_of});
  VoxelSet set;
  set.leaf_key = std::move(leaves.leaf_key);
  set.mask = exec.template make<LeafMask>(set.leaf_count());
  exec.fill(set.mask.view(), LeafMask{});
  exec.for_each(
      "enter voxels", count,
      EnterVoxel<VoxelOf>{
          voxel_of, {blocks, leaves.table.view(), leaves.words.view(), leaves.first.view()}, set.mask.view()});
  index_leaves(exec, set, extent_vox);
  return set;
}

}  // namespace isoshell
