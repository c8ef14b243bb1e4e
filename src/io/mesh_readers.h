// One reader a format. Each throws as read_mesh() does.
#pragma once

#include "io/mesh_source.h"
#include "isoshell/surface_source.h"

namespace isoshell {

TriangleSoup read_obj(const MeshSource& source);
TriangleSoup read_off(const MeshSource& source);
TriangleSoup read_ply(const MeshSource& source);
TriangleSoup read_stl(const MeshSource& source);

}  // namespace isoshell
