// Names of the grids of a .vdb or .nvdb file, as people write them.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace isoshell {

/// Names told apart: grids of the same name, and without one, get numbers as OpenVDB's own tools show them, density[0]
/// and density[1]. In files OpenVDB numbers them behind a character that nobody can type.
inline std::vector<std::string> names_apart(std::vector<std::string> names) {
  std::map<std::string, std::vector<size_t>> by_name;
  for (size_t i = 0; i < names.size(); ++i) by_name[names[i].substr(0, names[i].find('\x1e'))].push_back(i);
  for (const auto& [name, same] : by_name) {
    const bool numbered = same.size() > 1 || (name.empty() && names.size() > 1);
    for (size_t i = 0; i < same.size(); ++i) names[same[i]] = numbered ? name + "[" + std::to_string(i) + "]" : name;
  }
  return names;
}

}  // namespace isoshell
