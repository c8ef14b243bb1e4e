// voxelize (see stages.h), written once over an executor: blocks, then leaves, then voxels, each level only where the
// one above is occupied. Every leaf that a triangle meets has a voxel that it meets, since a leaf is the union of its
// voxels.
#pragma once

#include "isoshell/advanced/stages.h"
#include "stages/sites/leaf_triangles.h"

namespace isoshell {

struct MarkBlocks {
  View<const Tile> tiles;
  View<uint32_t> table;
  ISOSHELL_HD void operator()(int64_t i) const { atomic_min(table[tiles[i].block], 0u); }
};

struct IsMarked {
  View<const uint32_t> table;
  ISOSHELL_HD bool operator()(int64_t i) const { return table[i] != kNone; }
};

/// Key of a block: that of its first leaf without the leaf's own bits.
struct KeyBlocks {
  BlockGrid grid;
  View<const uint32_t> marked;
  View<uint64_t> key;
  ISOSHELL_HD void operator()(int64_t i) const {
    const Voxel b = grid.block(marked[i]);
    key[i] = leaf_key({b.x * 16, b.y * 16, b.z * 16}) >> 12;
  }
};

struct NumberBlocks {
  BlockGrid grid;
  View<const uint64_t> key;
  View<uint32_t> table;
  View<LeafBlock> blocks;
  ISOSHELL_HD void operator()(int64_t i) const {
    const Voxel leaf = leaf_of_key(key[i] << 12);
    table[grid.number({leaf.x >> 4, leaf.y >> 4, leaf.z >> 4})] = uint32_t(i);
    blocks[i] = LeafBlock{};
  }
};

struct MarkLeaves {
  SurfaceView surface;
  BlockGrid grid;
  View<const Tile> tiles;
  View<const uint32_t> table;
  View<LeafBlock> blocks;
  ISOSHELL_HD void operator()(int64_t i) const {
    LeafBlock& block = blocks[table[tiles[i].block]];
    for_each_cell<16>(surface.triangle(tiles[i].triangle), leaves_of_block(grid.block(tiles[i].block)), kLeafShift,
                      [&](Voxel leaf) {
                        const int bit = (leaf.x & 15) << 8 | (leaf.y & 15) << 4 | (leaf.z & 15);
                        const uint64_t flag = uint64_t(1) << (bit & 63);
                        uint64_t& word = block.word[bit >> 6];
                        if (!(atomic_load(word) & flag)) atomic_or(word, flag);
                      });
  }
};

struct CountLeaves {
  View<LeafBlock> blocks;
  View<int64_t> count;
  ISOSHELL_HD void operator()(int64_t i) const {
    int before = 0;
    for (int w = 0; w < 64; ++w) {
      blocks[i].before[w] = uint16_t(before);
      before += popcount64(blocks[i].word[w]);
    }
    count[i] = before;
  }
};

struct ListLeaves {
  View<const uint64_t> block_key;
  View<const int64_t> first;
  View<LeafBlock> blocks;
  View<uint64_t> leaf_key;
  ISOSHELL_HD void operator()(int64_t i) const {
    blocks[i].first_leaf = uint32_t(first[i]);
    int64_t at = first[i];
    for (int w = 0; w < 64; ++w)
      for (uint64_t bits = blocks[i].word[w]; bits; bits &= bits - 1)
        leaf_key[at++] = block_key[i] << 12 | uint64_t(w * 64 + lowest_bit(bits));
  }
};

struct MarkVoxels {
  SurfaceView surface;
  View<const uint64_t> leaf_key;
  View<const int64_t> first;
  View<const uint32_t> triangle;
  View<LeafMask> mask;
  View<int64_t> count;
  ISOSHELL_HD void operator()(int64_t l) const {
    const Voxel leaf = leaf_of_key(leaf_key[l]);
    LeafMask marked = {};
    for (int64_t i = first[l]; i < first[l + 1]; ++i) mark_voxels(surface.triangle(triangle[i]), leaf, marked);
    mask[l] = marked;
    count[l] = voxels_in(marked);
  }
};

/// Leaves and their index, without masks.
template <class Exec>
VoxelSet find_leaves(Exec& exec, const LatticeSurface& surface, const BlockGrid& grid, View<const Tile> tiles) {
  VoxelSet set;
  for (int axis = 0; axis < 3; ++axis) set.block_dims[axis] = grid.dims[axis];
  set.block_table = exec.template make<uint32_t>(int64_t(grid.dims[0]) * grid.dims[1] * grid.dims[2]);
  exec.fill(set.block_table.view(), kNone);
  exec.for_each("mark blocks", tiles.size, MarkBlocks{tiles, set.block_table.view()});
  const Buffer<uint32_t> marked = exec.select(set.block_table.size(), IsMarked{set.block_table.view()});

  const int64_t blocks = marked.size();
  Buffer<uint64_t> key = exec.template make<uint64_t>(blocks);
  exec.for_each("key blocks", blocks, KeyBlocks{grid, marked.view(), key.view()});
  exec.sort(key.view());
  set.blocks = exec.template make<LeafBlock>(blocks);
  exec.for_each("number blocks", blocks, NumberBlocks{grid, key.view(), set.block_table.view(), set.blocks.view()});

  exec.for_each("mark leaves", tiles.size,
                MarkLeaves{view_of(surface), grid, tiles, set.block_table.view(), set.blocks.view()});
  Buffer<int64_t> first = exec.template make<int64_t>(blocks);
  exec.for_each("count leaves", blocks, CountLeaves{set.blocks.view(), first.view()});
  set.leaf_key = exec.template make<uint64_t>(exec.exclusive_scan(first.view()));
  exec.for_each("list leaves", blocks, ListLeaves{key.view(), first.view(), set.blocks.view(), set.leaf_key.view()});
  return set;
}

inline BlockGrid block_grid(const LatticeFrame& frame) {
  return {{(frame.extent_vox[0] + 127) / 128, (frame.extent_vox[1] + 127) / 128, (frame.extent_vox[2] + 127) / 128}};
}

template <class Exec>
SiteSet voxelize_body(Exec& exec, const LatticeSurface& surface) {
  const BlockGrid grid = block_grid(surface.frame);
  const Buffer<Tile> tiles = find_tiles(exec, surface, grid);
  SiteSet sites;
  VoxelSet& set = sites.voxels;
  set = find_leaves(exec, surface, grid, tiles.view());
  const LeafTriangles lists = find_leaf_triangles(exec, surface, grid, tiles.view(), set.view());
  const int64_t leaves = set.leaf_count();
  set.mask = exec.template make<LeafMask>(leaves);
  set.first = exec.template make<int64_t>(leaves + 1);
  exec.fill(set.first.view(), int64_t(0));
  exec.for_each("mark voxels", leaves,
                MarkVoxels{view_of(surface), set.leaf_key.view(), lists.first.view(), lists.triangle.view(),
                           set.mask.view(), set.first.view()});
  set.active = exec.exclusive_scan(set.first.view());
  return sites;
}

}  // namespace isoshell
