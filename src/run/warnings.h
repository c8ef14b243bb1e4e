// What of a run a person should look at.
#pragma once

#include <string>
#include <vector>

#include "isoshell/region_census.h"
#include "isoshell/run/record.h"

namespace isoshell {

/// A sentence for every kind of dirt and repair that the report counts; edges of more than two faces are none of the
/// walls between regions. `input` is what messages call the input.
std::vector<std::string> warnings_of_repair(const RemeshReport& report, const std::string& input, bool has_regions);

/// What a run changed of regions and their walls, by label and name, without a full stop; empty where nothing.
std::string words_of(const RegionChanges& changes);

/// About the mesh itself: one sentence that names its worst angles and the options that make better ones, none when all
/// are 30 degrees or more.
std::vector<std::string> warnings_of_quality(const RunRecord& record);

/// That its numbers do not hold the triangles, without a full stop.
std::string words_of_lost(const WrittenFile& file);

}  // namespace isoshell
