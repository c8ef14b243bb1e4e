// The lattice: integer voxels and fixed-point positions, and the one place where they meet world units.
#pragma once

#include <cstdint>

#include "isoshell/advanced/host_device.h"

namespace isoshell {

constexpr int kFractionBits = 8;                     ///< bits below one voxel in a fixed-point position
constexpr int32_t kOneVoxelQ8 = 1 << kFractionBits;  ///< one voxel in 1/256 voxel
constexpr int32_t kMarginVox = 32;                   ///< empty voxels kept around the surface on every side
constexpr int32_t kMaxResolution = 8192;             ///< voxels along the longest side of the surface
constexpr int32_t kMaxExtentVox = kMaxResolution + 2 * kMarginVox + 8;  ///< voxels of a lattice along an axis
constexpr int32_t kMaxBandVox = 20;                                     ///< largest shell thickness d
constexpr int32_t kMaxClosingVox = 15;                                  ///< largest closing radius r

/// A voxel by its integer coordinates; never negative inside a lattice. Voxel i covers [256 i, 256 (i + 1)] in q8.
struct Voxel {
  int32_t x, y, z;
};
ISOSHELL_HD inline bool operator==(Voxel a, Voxel b) { return a.x == b.x && a.y == b.y && a.z == b.z; }
ISOSHELL_HD inline bool operator!=(Voxel a, Voxel b) { return !(a == b); }

/// A position in 1/256 voxel.
struct PointQ8 {
  int32_t x, y, z;
};
ISOSHELL_HD inline bool operator==(PointQ8 a, PointQ8 b) { return a.x == b.x && a.y == b.y && a.z == b.z; }
ISOSHELL_HD inline bool operator!=(PointQ8 a, PointQ8 b) { return !(a == b); }

/// A direction with components in -127..127, length 127 to rounding; (0,0,0) where undefined.
struct Normal8 {
  int8_t x, y, z;
};

/// A position in the input's coordinates.
struct WorldPoint {
  double x, y, z;
};

/// What lies between two corners, along the axes.
template <class Point>
struct BoxOf {
  Point min, max;  ///< the smallest coordinates, and the largest
};
using WorldBox = BoxOf<WorldPoint>;

/// How other programs number the voxels of a lattice, by the centres.
struct IndexSpace {
  Voxel first{0, 0, 0};            ///< the index of voxel (0,0,0), of multiples of 8
  WorldPoint zero_world{0, 0, 0};  ///< where index (0,0,0) lies
};

/// Where the lattice lies in the world. `origin` is the corner of voxel (0,0,0); the surface starts kMarginVox + 1/2
/// voxels in, or up to 8 more.
struct LatticeFrame {
  WorldPoint origin{0, 0, 0};
  double voxel_size = 1;       ///< world units
  int32_t resolution = 0;      ///< voxels along the longest side of the surface
  int32_t extent_vox[3] = {};  ///< lattice size per axis, a multiple of 8

  /// Frame whose longest side spans exactly `resolution` voxels of the box, smallest corner in the middle of a voxel.
  /// Throws: usage when resolution is outside 1..kMaxResolution, nothing_to_mesh when the box is empty or not finite.
  static LatticeFrame around(WorldPoint box_min, WorldPoint box_max, int32_t resolution);
  /// Frame of voxels of exactly this size around the box, whose centres are multiples of it: any two surfaces have the
  /// same voxels then, as those that OpenVDB makes. Throws: usage where the size gives fewer than 1 or more than
  /// kMaxResolution voxels along the longest side, nothing_to_mesh when the box is empty or not finite.
  static LatticeFrame on_multiples(WorldPoint box_min, WorldPoint box_max, double voxel_size);
  /// Of a frame on multiples the index is the multiple; of others it is the voxel.
  IndexSpace index_space() const;
  /// Nearest fixed-point position, halves up. The only way from world units into the lattice.
  PointQ8 snap(WorldPoint p) const;
  /// The only way back.
  WorldPoint to_world(PointQ8 q) const;
};

}  // namespace isoshell
