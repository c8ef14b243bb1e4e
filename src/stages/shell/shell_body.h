// build_shell (see stages.h), written once over an executor. Paper section 3.1.
//
// The shell's voxels are known before their values: dilating the sites' bitmaps by the ball is cheap, and with the
// counts in hand the values go straight to their place, so that the stage needs little more memory than its result.
#pragma once

#include "isoshell/advanced/stages.h"
#include "stages/sparse/drop_empty_leaves.h"
#include "voxel/atomic.h"
#include "voxel/closest.h"

namespace isoshell {
namespace shell_steps {

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

/// The two passes over a leaf, every voxel by itself.
struct PlainLeafPasses {
  /// Which voxels of the leaf in the middle lie within the ball's radius of a site.
  ISOSHELL_HD static void reached(const Neighbourhood& around, const LeafMask* sites, const Ball& ball, LeafMask& out) {
    out = LeafMask{};
    for (int offset = 0; offset < 512; ++offset) {
      uint64_t any = 0;
      for_each_site(around, sites, ball.radius, offset, [&](int, int, int) { any = 1; });
      out.word[offset >> 6] |= any << (offset & 63);
    }
  }
  /// Closest sites and squared distances of the leaf's `reached` voxels, in their order. See NumberWords for
  /// word_first.
  ISOSHELL_HD static void closest(const Neighbourhood& around, const LeafMask* sites, const uint32_t* word_first,
                                  int band_vox, const LeafMask& reached, uint32_t* closest_site,
                                  uint16_t* distance_sq_vox) {
    for (int offset = 0; offset < 512; ++offset) {
      if (!(reached.word[offset >> 6] >> (offset & 63) & 1)) continue;
      uint32_t least = kNoKey;
      for_each_site(around, sites, band_vox, offset, [&](int leaf, int in_leaf, int distance_sq) {
        const uint32_t key = key_of_distance_sq(distance_sq) | uint32_t(around.place[leaf]) << 9 | uint32_t(in_leaf);
        least = key < least ? key : least;
      });
      *closest_site++ = site_of_rank(around, sites, word_first, rank_of_key(least));
      *distance_sq_vox++ = uint16_t(distance_sq_of_key(least));
    }
  }

 private:
  /// Calls visit(number of the leaf in the cube, offset in it, squared distance) for the sites within the radius of the
  /// voxel at `offset` of the leaf in the middle.
  template <class Visit>
  ISOSHELL_HD static void for_each_site(const Neighbourhood& around, const LeafMask* sites, int radius, int offset,
                                        Visit visit) {
    const int middle = 8 * (around.span / 2);
    const int x = middle + (offset >> 6), y = middle + (offset >> 3 & 7), z = middle + (offset & 7);
    for (int dx = -radius; dx <= radius; ++dx)
      for (int dy = -radius; dy <= radius; ++dy)
        for (int dz = -radius; dz <= radius; ++dz) {
          const int distance_sq = dx * dx + dy * dy + dz * dz;
          const int leaf = around.at((x + dx) >> 3, (y + dy) >> 3, (z + dz) >> 3);
          if (distance_sq > radius * radius || around.leaf[leaf] == kNone) continue;
          const int word = (x + dx) & 7, bit = ((y + dy) & 7) << 3 | ((z + dz) & 7);
          if (sites[around.leaf[leaf]].word[word] >> bit & 1) visit(leaf, word << 6 | bit, distance_sq);
        }
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

/// Site id of the first voxel of every mask word.
struct NumberWords {
  VoxelSetView sites;
  View<uint32_t> word_first;
  ISOSHELL_HD void operator()(int64_t leaf) const {
    uint32_t at = uint32_t(sites.first[leaf]);
    for (int w = 0; w < 8; ++w) {
      word_first[leaf * 8 + w] = at;
      at += uint32_t(popcount64(sites.mask[leaf].word[w]));
    }
  }
};

template <class LeafPasses>
struct CloseLeaf {
  VoxelSetView sites, shell;
  int32_t band_vox;
  View<const uint32_t> word_first;
  View<uint32_t> closest_site;
  View<uint16_t> distance_sq_vox;
  void operator()(int64_t leaf) const {
    const int reach = reach_leaves(band_vox);
    const Voxel at = leaf_of_key(shell.leaf_key[leaf]);
    Neighbourhood around;
    find_neighbours(around, sites, at, reach);
    order_neighbours(around, {at.x - reach, at.y - reach, at.z - reach});
    const int64_t first = shell.first[leaf];
    LeafPasses::closest(around, sites.mask.data, word_first.data, band_vox, shell.mask[leaf], &closest_site[first],
                        &distance_sq_vox[first]);
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

/// The shell's topology: every voxel within the ball's radius of a site.
template <class LeafPasses, class Exec>
VoxelSet reach(Exec& exec, const VoxelSetView& sites, const Ball& ball) {
  const Buffer<uint64_t> key = list_reached_leaves(exec, sites, ball);
  Buffer<LeafMask> mask = exec.template make<LeafMask>(key.size());
  exec.for_each("reach", key.size(), ReachLeaf<LeafPasses>{sites, ball, key.view(), mask.view()});
  return voxel_set_of(exec, key.view(), mask.view(), BlockExtent(sites).vox);
}

}  // namespace shell_steps

template <class Exec>
Shell build_shell_body(Exec& exec, const SiteSet& site_set, const ShellOptions& options) {
  using namespace shell_steps;
  using LeafPasses = typename Exec::Kernels::LeafPasses;
  const VoxelSetView sites = site_set.voxels.view();
  Shell shell;
  shell.band_vox = options.band_vox;
  shell.voxels = reach<LeafPasses>(exec, sites, ball_of_radius(options.band_vox));
  Buffer<uint32_t> word_first = exec.template make<uint32_t>(sites.leaf_key.size * 8);
  exec.for_each("number site words", sites.leaf_key.size, NumberWords{sites, word_first.view()});
  shell.closest_site = exec.template make<uint32_t>(shell.voxels.voxel_count());
  shell.distance_sq_vox = exec.template make<uint16_t>(shell.voxels.voxel_count());
  exec.for_each("closest sites", shell.voxels.leaf_count(),
                CloseLeaf<LeafPasses>{sites, shell.voxels.view(), options.band_vox, word_first.view(),
                                      shell.closest_site.view(), shell.distance_sq_vox.view()});
  return shell;
}

/// A shell that another body needs on its way.
struct PlainBuildShell {
  template <class Exec>
  static Shell run(Exec& exec, const SiteSet& sites, const ShellOptions& options) {
    return build_shell_body(exec, sites, options);
  }
};

}  // namespace isoshell
