// World units in and out of the lattice. Only + - * / and floor, so every machine gives the same bits.
#include "isoshell/advanced/lattice.h"

#include <algorithm>
#include <cmath>

#include "isoshell/error.h"
#include "voxel/snap.h"

namespace isoshell {

LatticeFrame LatticeFrame::around(WorldPoint lo, WorldPoint hi, int32_t resolution) {
  if (resolution < 1 || resolution > kMaxResolution)
    throw Error(ErrorCode::usage, "lattice",
                "resolution is " + std::to_string(resolution) + "; it must be 1 to " + std::to_string(kMaxResolution));
  const double side[3] = {hi.x - lo.x, hi.y - lo.y, hi.z - lo.z};
  const double longest = std::max({side[0], side[1], side[2]});
  if (!(longest > 0) || !std::isfinite(longest))
    throw Error(ErrorCode::nothing_to_mesh, "lattice",
                "the surface's box has no extent; a mesh needs at least one side");
  LatticeFrame frame;
  frame.resolution = resolution;
  frame.voxel_size = resolution > 1 ? longest / (resolution - 1) : longest * 2;
  const double shift = (kMarginVox + 0.5) * frame.voxel_size;
  frame.origin = {lo.x - shift, lo.y - shift, lo.z - shift};
  for (int axis = 0; axis < 3; ++axis) {
    const int32_t span = int32_t(std::floor(side[axis] / frame.voxel_size + 0.5)) + 1;
    frame.extent_vox[axis] = (span + 2 * kMarginVox + 7) / 8 * 8;
  }
  return frame;
}

PointQ8 LatticeFrame::snap(WorldPoint p) const { return snap_point(*this, p); }

WorldPoint LatticeFrame::to_world(PointQ8 q) const {
  const double step = voxel_size / kOneVoxelQ8;
  return {origin.x + q.x * step, origin.y + q.y * step, origin.z + q.z * step};
}

}  // namespace isoshell
