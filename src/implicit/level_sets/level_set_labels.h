// Level sets that are regions: which of them each voxel belongs to, and where the walls between them run.
#pragma once

#include <string>
#include <vector>

#include "implicit/level_sets/level_sets.h"
#include "isoshell/backend.h"
#include "isoshell/regions.h"

namespace isoshell {

struct LabelsOfLevelSets {
  LabelVolume volume;
  /// Of each level set that has no voxel, and of those that overlap where both have the value beyond the narrowest
  /// band, which the first one gets.
  std::vector<std::string> warnings;
};

/// The labels 1, 2, ... in their order; names are of those that have a voxel. A voxel is of the level set with the
/// least value there, if that is below 0, and of the first of several that have it. So it is between two that face each
/// other, as their slopes are nearly opposite, with a gap of at most a voxel: in the ball that has the points of both
/// nearest to it as ends of a diameter. Walls cross the lines between centres of voxels where the two values are equal,
/// or the value is 0, and have the slope of their difference as normal. Result: the same for any number of threads.
/// Cost: linear in the box of all, 4 bytes a voxel. Throws: nothing_to_mesh where no value is
/// below 0; out_of_memory over the context's limit, and as LevelSetVoxels does; interrupted.
LabelsOfLevelSets labels_of_level_sets(const LevelSets& sets, const Context& context);

}  // namespace isoshell
