// Grids that are sampled, of a .vdb file whose bytes are in memory.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "io/bytes/mesh_source.h"
#include "isoshell/io/grid_field.h"

namespace isoshell {

/// read_grid_fields() of the source, whose budget counts the grids; "all" are all but the one that meshed_grid() gives,
/// and each is read once. Throws: as it does.
std::vector<std::shared_ptr<const GridField>> read_grid_fields(const MeshSource& source,
                                                               const std::vector<std::string>& names,
                                                               const std::string& meshed);

}  // namespace isoshell
