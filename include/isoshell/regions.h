// Regions: the labelled parts of space that a surface parts from one another, and volumes of labels.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "isoshell/advanced/lattice.h"

namespace isoshell {

/// What a person calls a region.
struct RegionName {
  int32_t label;
  std::string name;
};

/// The regions that the faces of a mesh part from one another. Faces of a mesh without regions bound one solid.
struct FaceRegions {
  /// Per triangle the label of the region behind it and of the one in front, that its normal points into. The first one
  /// of two is never the background; of two that are not it is the smaller one. Of a sheet both are the label of what
  /// it lies in, or the background. Empty: no regions.
  std::vector<std::array<int32_t, 2>> labels;
  int32_t background = 0;      ///< the label of what is no region
  bool are_of_voxels = false;  ///< walls of a volume, which have no creases that are more than steps of its voxels
  /// Between such voxels the shortest step, where they lie along the axes of the world and the other steps are whole
  /// multiples of it; 0 where not.
  double voxel_size_world = 0;
  /// Between such voxels, per triangle: on which side of the volume it lies, 1 to 6, and 0 on none. There walls are
  /// cut, and flat. Empty: not known.
  std::vector<uint8_t> side = {};
  /// Along axes on which the volume goes on with its other side: how long it is. There opposite sides, 1 and 2 of x and
  /// so on, get the same triangles, translated. 0: not so.
  WorldPoint period_world{0, 0, 0};
  std::vector<RegionName> names = {};  ///< ascending by label; labels may have none

  bool empty() const { return labels.empty(); }
  bool is_periodic() const { return period_world.x != 0 || period_world.y != 0 || period_world.z != 0; }
  bool is_periodic_side(uint8_t number) const {
    const double period[4] = {0, period_world.x, period_world.y, period_world.z};
    return period[(number + 1) / 2] != 0;
  }
};

/// Whether a face with these labels lies in one region, or in the background, and so bounds none: it is of a sheet.
inline bool is_of_sheet(const std::array<int32_t, 2>& labels) { return labels[0] == labels[1]; }

/// Where a wall crosses the line between the centres of two voxels of different labels.
struct WallCrossing {
  int64_t face = 0;  ///< 3 times the number of the voxel with the larger coordinates, and the axis between the two
  float at = 0.5F;   ///< from the centre of the smaller one (0) to that of the larger one (1)
  std::array<float, 3> normal{0, 0, 0};  ///< of the wall, of length 1 along the array's axes; 0: not known
};

/// Labels of voxels on a regular lattice. The centre of voxel (i, j, k) is at origin + i * step[0] + j * step[1] +
/// k * step[2]; what lies outside of the array is background.
struct LabelVolume {
  std::array<int32_t, 3> size_vox{0, 0, 0};
  std::vector<int32_t> labels;  ///< i fastest, then j, then k
  WorldPoint origin_world{0, 0, 0};
  std::array<WorldPoint, 3> step_world{WorldPoint{1, 0, 0}, WorldPoint{0, 1, 0}, WorldPoint{0, 0, 1}};
  int32_t background = 0;
  std::vector<RegionName> names = {};  ///< ascending by label
  /// Islands of fewer voxels get the label around them before anything is meshed; 0: none do.
  int64_t smallest_island_vox = 8;
  /// How far walls may leave the faces of their voxels along each axis, kLeastSmoothing to 1, and a quarter farther
  /// where regions meet in curves. At 0 they are these faces, flat, and where they turn are creases.
  double smoothing_vox = 0.5;
  /// Along which axes the array goes on with its first layer. The walls are then those of one period, from the centres
  /// of the first layer to those of its repetition, and on both of these sides they have the same curves.
  std::array<bool, 3> is_periodic{false, false, false};
  /// Ascending by face. Where they are given walls run through them, and are not made smooth beyond that; a wall that
  /// none is of lies in the middle.
  std::vector<WallCrossing> crossings = {};
  static constexpr double kLeastSmoothing = 0.05;  ///< that parts walls which touch one another in edges of voxels
};

}  // namespace isoshell
