// Regions as writers of meshes have them: the faces between each pair of regions, and what a pair is called.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "isoshell/attribute.h"
#include "isoshell/regions.h"

namespace isoshell {

/// The pairs of labels that faces have, ascending.
struct RegionPairs {
  std::vector<std::array<int32_t, 2>> labels;
  std::vector<uint32_t> of_face;  ///< per face its pair
};
RegionPairs pairs_of(const FaceRegions& regions);

/// "femur_0" for each pair, the regions' names where they have any, else their numbers. Blanks within names become
/// underscores. Where two pairs would be called the same, they have their numbers.
std::vector<std::string> names_of(const RegionPairs& pairs, const FaceRegions& regions);

/// The pairs as groups of faces; where the faces are in groups already, which may be null, behind those, as OBJ lists
/// several groups.
Attribute groups_of_regions(const FaceRegions& regions, const Attribute* groups);

}  // namespace isoshell
