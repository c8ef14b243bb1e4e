// build_shell (see stages.h), written once over an executor. Paper section 3.1.
//
// The shell's voxels are known before their values: dilating the sites' bitmaps by the ball is cheap, and with the
// counts in hand the values go straight to their place, so that the stage needs little more memory than its result.
#pragma once

#include "isoshell/advanced/stages.h"
#include "stages/sparse/reach.h"
#include "voxel/closest.h"

namespace isoshell {
namespace shell_steps {

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

}  // namespace shell_steps

template <class Exec>
Shell build_shell_body(Exec& exec, const SiteSet& site_set, const ShellOptions& options) {
  using namespace shell_steps;
  using LeafPasses = typename Exec::Kernels::LeafPasses;
  const VoxelSetView sites = site_set.voxels.view();
  Shell shell;
  shell.band_vox = options.band_vox;
  shell.voxels = reach_steps::reach<LeafPasses>(exec, sites, ball_of_radius(options.band_vox));
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
