// What of a run a person should look at.
#pragma once

#include <string>
#include <vector>

#include "isoshell/quality.h"
#include "isoshell/region_census.h"
#include "isoshell/remesh.h"

namespace isoshell {

/// A sentence for every kind of dirt and repair that the report counts; edges of more than two faces are none of the
/// walls between regions. `input` is what messages call the input.
std::vector<std::string> warnings_of_repair(const RemeshReport& report, const std::string& input, bool has_regions);

/// What a run changed of regions and their walls, by label and name, without a full stop; empty where nothing.
std::string words_of(const RegionChanges& changes);

/// About the mesh itself: one sentence that names its worst angles, none when all are 30 degrees or more.
std::vector<std::string> warnings_of_quality(const MeshQuality& quality);

}  // namespace isoshell
