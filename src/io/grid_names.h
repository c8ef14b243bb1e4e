// Names of the grids of a .vdb or .nvdb file, as people write them.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace isoshell {

/// Grids with names told apart: those of the same name, and without one, get numbers as OpenVDB's own tools show them,
/// density[0] and density[1]. In files OpenVDB numbers them behind a character that nobody can type.
template <class Grid>
std::vector<Grid> with_names_apart(std::vector<Grid> grids) {
  std::map<std::string, std::vector<Grid*>> by_name;
  for (Grid& grid : grids) by_name[grid.name.substr(0, grid.name.find('\x1e'))].push_back(&grid);
  for (const auto& [name, same] : by_name) {
    const bool numbered = same.size() > 1 || (name.empty() && grids.size() > 1);
    for (size_t i = 0; i < same.size(); ++i) same[i]->name = numbered ? name + "[" + std::to_string(i) + "]" : name;
  }
  return grids;
}

}  // namespace isoshell
