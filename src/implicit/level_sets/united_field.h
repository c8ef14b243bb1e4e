// Several level sets as one.
#pragma once

#include <memory>

#include "implicit/level_sets/level_set_labels.h"

namespace isoshell {

/// The field that has the least of their values everywhere, under the file and class of the first one. Throws: as
/// distance_blocks_of. Cost: linear in the blocks of all.
std::unique_ptr<ScalarField> united_level_sets(LevelSets sets, const Context& context);

}  // namespace isoshell
