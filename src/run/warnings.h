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

/// Which regions have another volume than the surface gives them, by more than can be overlooked; without a full stop,
/// empty where none has.
std::string words_of(const std::vector<RegionVolumes>& volumes);

/// About the mesh itself, with the options that make a better one: its worst angles, where any is below 30 degrees, and
/// of regions walls that meet at less than 5.
std::vector<std::string> warnings_of_quality(const RunRecord& record);

/// That its numbers do not hold the triangles, without a full stop.
std::string words_of_lost(const WrittenFile& file);

}  // namespace isoshell
