// A certificate as people read it.
#pragma once

#include <string>

#include "isoshell/run/mesh_info.h"

namespace isoshell::tool {

std::string mesh_info_table(const MeshInfo& info);

}  // namespace isoshell::tool
