// The arithmetic of LatticeFrame::snap, for steps on any backend. Only + - * / and floor, so the same bits everywhere.
// Not in the public header: there it would be compiled with flags that are not ours.
#pragma once

#include "isoshell/advanced/lattice.h"

namespace isoshell {

ISOSHELL_HD inline int32_t snap_coordinate(double world, double origin, double voxel_size) {
  const double steps = (world - origin) / voxel_size * kOneVoxelQ8 + 0.5;
#if defined(__CUDA_ARCH__)
  return int32_t(floor(steps));
#else
  return int32_t(__builtin_floor(steps));
#endif
}
/// Nearest fixed-point position, halves up.
ISOSHELL_HD inline PointQ8 snap_point(const LatticeFrame& frame, WorldPoint p) {
  return {snap_coordinate(p.x, frame.origin.x, frame.voxel_size),
          snap_coordinate(p.y, frame.origin.y, frame.voxel_size),
          snap_coordinate(p.z, frame.origin.z, frame.voxel_size)};
}

}  // namespace isoshell
