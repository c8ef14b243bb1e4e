// The passes of the shell over one leaf, eight voxels of a row at a time.
#pragma once

#include "voxel/closest.h"

namespace isoshell {

/// shell_steps::PlainLeafPasses in lanes.
struct LeafSimd {
  /// Which voxels of the leaf in the middle lie within the ball's radius of a site.
  static void reached(const Neighbourhood& around, const LeafMask* sites, const Ball& ball, LeafMask& out);
  /// Closest sites and squared distances of the leaf's `reached` voxels, in their order. See NumberWords for
  /// word_first.
  static void closest(const Neighbourhood& around, const LeafMask* sites, const uint32_t* word_first, int band_vox,
                      const LeafMask& reached, uint32_t* closest_site, uint16_t* distance_sq_vox);
};

}  // namespace isoshell
