// What is found of the parts of a soup.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "isoshell/part_regions.h"
#include "regions/region_oracle.h"
#include "support/test_context.h"

namespace isoshell {

inline PartRegions regions_of(const TriangleSoup& soup, const std::string& parts) {
  CpuContext context;
  return find_part_regions(soup, {parts}, context);
}

inline double volume_of(const TriangleSoup& walls, int32_t label) {
  return volumes_of_regions(walls.vertices, walls.triangles, walls.regions)[label];
}

inline void add_groups(TriangleSoup& soup, const std::vector<std::pair<std::string, size_t>>& groups) {
  Attribute a{kGroupName, NumberType::i32, 1, {}, AttributeDomain::face};
  for (const auto& [name, faces] : groups) {
    a.values.insert(a.values.end(), faces, double(a.labels.size()));
    a.labels.push_back(name);
  }
  soup.attributes.push_back(std::move(a));
}

}  // namespace isoshell
