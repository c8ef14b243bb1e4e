// Sites as far as the band where the passes of the distance transform do not go that far.
#pragma once

#include "cuda/shell/closest_input.cuh"

namespace isoshell {
namespace closest {

/// Longest step along an axis that the passes take. With 9 they would need a window of five leaves for the voxels nine
/// straight ahead alone, which are looked up instead.
template <int kBand>
constexpr int kMostSteps = kBand == 9 ? 8 : kBand;

/// Voxels whose sites may be as far as the band.
template <int kBand>
struct FarVoxels {
  static constexpr int kRoom = kBand > kMostSteps<kBand> ? 64 : 1;
  uint32_t leaf[kRoom];
  uint32_t place[kRoom];  ///< among the leaf's active voxels, above nine bits of offset
};

/// The smallest among the passes' site and those straight ahead. Seldom, so kept out of the way.
template <int kBand>
__device__ __noinline__ void lower_to_far_site(const Input& in, const Output& out, uint32_t leaf, uint32_t place) {
  const Voxel at = voxel_at(leaf_of_key(in.shell.leaf_key[leaf]), int(place & 511));
  uint32_t& closest = out.closest_site[in.shell.first[leaf] + (place >> 9)];
  uint32_t best = closest;
#pragma unroll 1
  for (int n = 0; n < 6; ++n) {
    const int by = n & 1 ? kBand : -kBand;
    const Voxel v = {at.x + (n >> 1 == 0 ? by : 0), at.y + (n >> 1 == 1 ? by : 0), at.z + (n >> 1 == 2 ? by : 0)};
    const uint32_t site_leaf = find_leaf(in.sites, leaf_of_voxel(v));
    if (site_leaf == kNone) continue;
    const SiteWord word = in.words[int64_t(site_leaf) * 8 + (v.x & 7)];
    const int bit = offset_in_leaf(v) & 63;
    if (word.bits >> bit & 1) best = min(best, site_number(word, bit));
  }
  closest = best;
}

}  // namespace closest
}  // namespace isoshell
