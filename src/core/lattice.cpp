// World units in and out of the lattice. Only + - * / and floor, so every machine gives the same bits.
#include "isoshell/advanced/lattice.h"

#include <algorithm>
#include <cmath>

#include "isoshell/error.h"
#include "voxel/snap.h"

namespace isoshell {
namespace {

constexpr double kMostIndex = 1 << 30;    ///< of OpenVDB's, which are 32 bits wide
constexpr double kOfOneCentreVox = 1e-6;  ///< centres that lie no farther apart are one

void check_longest(double longest) {
  if (!(longest > 0) || !std::isfinite(longest))
    throw Error(ErrorCode::nothing_to_mesh, "lattice",
                "the surface's box has no extent; a mesh needs at least one side");
}

void check_resolution(double resolution) {
  if (!(resolution >= 1 && resolution <= kMaxResolution))
    throw Error(ErrorCode::usage, "lattice",
                "resolution is " + std::to_string(int64_t(std::clamp(resolution, -1e9, 1e9))) + "; it must be 1 to " +
                    std::to_string(kMaxResolution));
}

/// The nearest multiple of `voxel_size`, halves up.
double multiple_at(double world, double voxel_size) { return std::floor(world / voxel_size + 0.5); }

int32_t in_leaves(int32_t voxels) { return (voxels + 7) / 8 * 8; }

/// The index of the first voxel along an axis, where it is a multiple of 8.
bool has_index(double origin, double voxel_size, int32_t& index) {
  const double first = origin / voxel_size + 0.5, whole = std::floor(first + 0.5);
  if (std::abs(first - whole) > kOfOneCentreVox || std::abs(whole) > kMostIndex || std::fmod(whole, 8) != 0)
    return false;
  index = int32_t(whole);
  return true;
}

}  // namespace

LatticeFrame LatticeFrame::around(WorldPoint lo, WorldPoint hi, int32_t resolution) {
  check_resolution(resolution);
  const double side[3] = {hi.x - lo.x, hi.y - lo.y, hi.z - lo.z};
  const double longest = std::max({side[0], side[1], side[2]});
  check_longest(longest);
  LatticeFrame frame;
  frame.resolution = resolution;
  frame.voxel_size = resolution > 1 ? longest / (resolution - 1) : longest * 2;
  const double shift = (kMarginVox + 0.5) * frame.voxel_size;
  frame.origin = {lo.x - shift, lo.y - shift, lo.z - shift};
  for (int axis = 0; axis < 3; ++axis) {
    const int32_t span = int32_t(std::floor(side[axis] / frame.voxel_size + 0.5)) + 1;
    frame.extent_vox[axis] = in_leaves(span + 2 * kMarginVox);
  }
  return frame;
}

LatticeFrame LatticeFrame::on_multiples(WorldPoint lo, WorldPoint hi, double voxel_size) {
  const double low[3] = {lo.x, lo.y, lo.z}, high[3] = {hi.x, hi.y, hi.z};
  const double longest = std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]});
  check_longest(longest);
  const double resolution = multiple_at(longest, voxel_size) + 1;
  check_resolution(resolution);
  LatticeFrame frame;
  frame.resolution = int32_t(resolution);
  frame.voxel_size = voxel_size;
  double origin[3];
  for (int axis = 0; axis < 3; ++axis) {
    const double first = std::floor((multiple_at(low[axis], voxel_size) - kMarginVox) / 8) * 8;
    origin[axis] = (first - 0.5) * voxel_size;
    frame.extent_vox[axis] = in_leaves(int32_t(multiple_at(high[axis], voxel_size) - first) + 1 + kMarginVox);
  }
  frame.origin = {origin[0], origin[1], origin[2]};
  return frame;
}

IndexSpace LatticeFrame::index_space() const {
  IndexSpace space;
  Voxel& first = space.first;
  if (has_index(origin.x, voxel_size, first.x) && has_index(origin.y, voxel_size, first.y) &&
      has_index(origin.z, voxel_size, first.z))
    return space;
  const double half = voxel_size / 2;
  return {{0, 0, 0}, {origin.x + half, origin.y + half, origin.z + half}};
}

PointQ8 LatticeFrame::snap(WorldPoint p) const { return snap_point(*this, p); }

WorldPoint LatticeFrame::to_world(PointQ8 q) const {
  const double step = voxel_size / kOneVoxelQ8;
  return {origin.x + q.x * step, origin.y + q.y * step, origin.z + q.z * step};
}

}  // namespace isoshell
