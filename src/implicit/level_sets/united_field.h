// Several level sets as one.
#pragma once

#include <memory>

#include "implicit/level_sets/level_sets.h"

namespace isoshell {

/// The field that has the least of their values everywhere, with gaps closed as those of regions are, under the file
/// and class of the first one. Throws: as LevelSetVoxels does. Cost: linear in the blocks of all.
std::unique_ptr<ScalarField> united_level_sets(LevelSets sets);

}  // namespace isoshell
