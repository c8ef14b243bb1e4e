// Names of labels as metadata of a grid: "label:7" is "femur".
#pragma once

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "isoshell/regions.h"

namespace isoshell {

constexpr char kLabelKey[] = "label:";

inline std::string label_key(int32_t label) { return kLabelKey + std::to_string(label); }

/// Ascending by label. A key whose number is not written as label_key() writes it is no name.
inline std::vector<RegionName> label_names_of(const std::map<std::string, std::string>& texts) {
  std::vector<RegionName> names;
  for (const auto& [key, name] : texts) {
    if (key.compare(0, sizeof kLabelKey - 1, kLabelKey) != 0 || name.empty()) continue;
    const long long number = std::strtoll(key.c_str() + sizeof kLabelKey - 1, nullptr, 10);
    if (number < std::numeric_limits<int32_t>::min() || number > std::numeric_limits<int32_t>::max()) continue;
    if (label_key(int32_t(number)) == key) names.push_back({int32_t(number), name});
  }
  std::sort(names.begin(), names.end(), [](const RegionName& a, const RegionName& b) { return a.label < b.label; });
  return names;
}

}  // namespace isoshell
