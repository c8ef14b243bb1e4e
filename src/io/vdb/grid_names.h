// Names of the grids of a .vdb or .nvdb file, as people write them.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace isoshell {

/// Grids with names told apart: those of the same name, and without one, get numbers as OpenVDB's own tools show them,
/// density[0] and density[1]. In files OpenVDB numbers them behind a character that nobody can type. A number that
/// would give the name of another grid as it stands in the file is left out: each name here is one grid's.
template <class Grid>
std::vector<Grid> with_names_apart(std::vector<Grid> grids) {
  std::map<std::string, std::vector<Grid*>> by_name;
  for (Grid& grid : grids) by_name[grid.name.substr(0, grid.name.find('\x1e'))].push_back(&grid);
  for (const auto& [name, same] : by_name) {
    const bool numbered = same.size() > 1 || (name.empty() && grids.size() > 1);
    int number = 0;
    for (Grid* const grid : same) {
      grid->name = name;
      while (numbered && by_name.count(grid->name)) grid->name = name + "[" + std::to_string(number++) + "]";
    }
  }
  return grids;
}

}  // namespace isoshell
