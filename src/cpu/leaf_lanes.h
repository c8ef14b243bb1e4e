// The passes of the shell over one leaf, eight voxels of a row at a time.
#pragma once

#include "voxel/closest.h"

namespace isoshell {

/// Leaf passes of build_shell_body for the CPU.
struct LeafLanes {
  /// Which voxels of the leaf in the middle lie within the ball's radius of a site.
  static void reached(const Neighbourhood& around, const LeafMask* sites, const Ball& ball, LeafMask& out);
  /// The smallest key of every voxel of that leaf, by offset; exact where the squared distance is at most band_vox^2.
  static void closest(const Neighbourhood& around, const LeafMask* sites, int band_vox, uint32_t keys[512]);
};

}  // namespace isoshell
