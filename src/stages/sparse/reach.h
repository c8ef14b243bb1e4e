// Dilation of voxel sets: every voxel within a radius of one of a set.
#pragma once

#include "isoshell/advanced/site_set.h"
#include "stages/sparse/drop_empty_leaves.h"
#include "voxel/atomic.h"
#include "voxel/closest.h"

namespace isoshell {
namespace reach_steps {

/// Leaves that may hold voxels within the radius of a leaf's sites: calls run(x, y, first z, last z), leaf coordinates.
template <class Run>
ISOSHELL_HD inline void for_each_reached_run(const VoxelSetView& sites, int64_t leaf, const Ball& ball, Run run) {
  const LeafMask& mask = sites.mask[leaf];
  uint64_t all = 0;
  int x0 = 8, x1 = 0;
  for (int x = 0; x < 8; ++x) {
    all |= mask.word[x];
    if (!mask.word[x]) continue;
    x0 = x0 < x ? x0 : x;
    x1 = x;
  }
  if (!all) return;
  int y0 = 8, y1 = 0, z0 = 8, z1 = 0;
  for (int i = 0; i < 8; ++i) {
    if (all >> (8 * i) & 255) y0 = y0 < i ? y0 : i, y1 = i;
    if (all >> i & 0x0101010101010101ull) z0 = z0 < i ? z0 : i, z1 = i;
  }
  const Voxel at = leaf_of_key(sites.leaf_key[leaf]);
  const int reach = reach_leaves(ball.radius);
  // Gap between the box of the sites and the leaf `l` leaves away, along one axis.
  const auto gap = [](int lo, int hi, int l) { return 8 * l > hi ? 8 * l - hi : lo > 8 * l + 7 ? lo - 8 * l - 7 : 0; };
  for (int x = -reach; x <= reach; ++x)
    for (int y = -reach; y <= reach; ++y) {
      const int gx = gap(x0, x1, x), gy = gap(y0, y1, y);
      if (gx > ball.radius || gy > ball.radius || ball.half[gx][gy] < 0) continue;
      const Voxel l = {at.x + x, at.y + y, 0};
      if (l.x < 0 || l.y < 0 || l.x >= sites.block_dims[0] * 16 || l.y >= sites.block_dims[1] * 16) continue;
      const int first = at.z + ((z0 - ball.half[gx][gy]) >> 3), last = at.z + ((z1 + ball.half[gx][gy]) >> 3);
      const int end = sites.block_dims[2] * 16 - 1;
      run(l.x, l.y, first > 0 ? first : 0, last < end ? last : end);
    }
}

ISOSHELL_HD inline int64_t block_at(const VoxelSetView& set, int x, int y, int z) {
  return (int64_t(x >> 4) * set.block_dims[1] + (y >> 4)) * set.block_dims[2] + (z >> 4);
}

struct MarkBlocks {
  VoxelSetView sites;
  Ball ball;
  View<uint32_t> table;
  ISOSHELL_HD void operator()(int64_t leaf) const {
    for_each_reached_run(sites, leaf, ball, [this](int x, int y, int z0, int z1) {
      for (int z = z0 & ~15; z <= z1; z += 16) {
        uint32_t& mark = table[block_at(sites, x, y, z)];
        if (!mark) atomic_or(mark, 1u);
      }
    });
  }
};

struct IsMarked {
  View<const uint32_t> table;
  ISOSHELL_HD bool operator()(int64_t i) const { return table[i] != 0; }
};

struct KeyOfBlock {
  VoxelSetView sites;
  View<const uint32_t> marked;
  View<uint64_t> key;
  ISOSHELL_HD void operator()(int64_t i) const {
    const int32_t z = int32_t(marked[i] % uint32_t(sites.block_dims[2])),
                  xy = int32_t(marked[i] / uint32_t(sites.block_dims[2]));
    key[i] = leaf_key({xy / sites.block_dims[1] * 16, xy % sites.block_dims[1] * 16, z * 16}) >> 12;
  }
};

struct NumberBlock {
  VoxelSetView sites;
  View<const uint64_t> key;
  View<uint32_t> table;
  ISOSHELL_HD void operator()(int64_t i) const {
    const Voxel leaf = leaf_of_key(key[i] << 12);
    table[block_at(sites, leaf.x, leaf.y, leaf.z)] = uint32_t(i);
  }
};

/// Sets a bit per reached leaf, 64 words a block, in key order.
struct MarkLeaves {
  VoxelSetView sites;
  Ball ball;
  View<const uint32_t> table;
  View<uint64_t> words;
  ISOSHELL_HD void operator()(int64_t leaf) const {
    for_each_reached_run(sites, leaf, ball, [this](int x, int y, int z0, int z1) {
      for (int z = z0 & ~15; z <= z1; z += 16) {
        const int lo = z0 > z ? z0 - z : 0, hi = z1 < z + 15 ? z1 - z : 15;
        const int bit = (x & 15) << 8 | (y & 15) << 4;
        const uint64_t run = ((uint64_t(2) << hi) - (uint64_t(1) << lo)) << (bit & 63);
        uint64_t& word = words[int64_t(table[block_at(sites, x, y, z)]) * 64 + (bit >> 6)];
        if ((word & run) != run) atomic_or(word, run);
      }
    });
  }
};

struct CountBits {
  View<const uint64_t> words;
  View<int64_t> count;
  ISOSHELL_HD void operator()(int64_t i) const { count[i] = popcount64(words[i]); }
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

/// The voxels of a leaf that the ball around some site reaches.
template <class LeafPasses>
struct ReachLeaf {
  VoxelSetView sites;
  Ball ball;
  View<const uint64_t> leaf_key;
  View<LeafMask> mask;
  void operator()(int64_t i) const {
    Neighbourhood around;
    find_neighbours(around, sites, leaf_of_key(leaf_key[i]), reach_leaves(ball.radius));
    LeafPasses::reached(around, sites.mask.data, ball, mask[i]);
  }
};

/// Leaves within reach of the sites, ascending; some may turn out empty.
template <class Exec>
Buffer<uint64_t> list_reached_leaves(Exec& exec, const VoxelSetView& sites, const Ball& ball) {
  Buffer<uint32_t> table = exec.template make<uint32_t>(sites.block_table.size);
  exec.fill(table.view(), 0u);
  exec.for_each("mark blocks", sites.leaf_key.size, MarkBlocks{sites, ball, table.view()});
  const Buffer<uint32_t> marked = exec.select(table.size(), IsMarked{table.view()});
  Buffer<uint64_t> block_key = exec.template make<uint64_t>(marked.size());
  exec.for_each("block keys", marked.size(), KeyOfBlock{sites, marked.view(), block_key.view()});
  exec.sort(block_key.view());
  exec.for_each("number blocks", marked.size(), NumberBlock{sites, block_key.view(), table.view()});

  Buffer<uint64_t> words = exec.template make<uint64_t>(marked.size() * 64);
  exec.fill(words.view(), uint64_t(0));
  exec.for_each("mark leaves", sites.leaf_key.size, MarkLeaves{sites, ball, table.view(), words.view()});
  Buffer<int64_t> first = exec.template make<int64_t>(words.size());
  exec.for_each("count leaves", words.size(), CountBits{words.view(), first.view()});
  Buffer<uint64_t> leaf_key = exec.template make<uint64_t>(exec.exclusive_scan(first.view()));
  exec.for_each("list leaves", words.size(), ListLeaves{words.view(), block_key.view(), first.view(), leaf_key.view()});
  return leaf_key;
}

/// Every voxel within the ball's radius of one of the set.
template <class LeafPasses, class Exec>
VoxelSet reach(Exec& exec, const VoxelSetView& sites, const Ball& ball) {
  const Buffer<uint64_t> key = list_reached_leaves(exec, sites, ball);
  Buffer<LeafMask> mask = exec.template make<LeafMask>(key.size());
  exec.for_each("reach", key.size(), ReachLeaf<LeafPasses>{sites, ball, key.view(), mask.view()});
  return voxel_set_of(exec, key.view(), mask.view(), BlockExtent(sites).vox);
}

}  // namespace reach_steps

/// The voxels within a radius of those of a set, for a body that needs no closest sites.
struct PlainDilate {
  template <class Exec>
  static VoxelSet run(Exec& exec, const SiteSet& sites, int32_t radius_vox) {
    return reach_steps::reach<typename Exec::Kernels::LeafPasses>(exec, sites.voxels.view(),
                                                                  ball_of_radius(radius_vox));
  }
};

}  // namespace isoshell
