// The lines of an OBJ file, the edges of a PLY file. Each throws as read_polylines() does.
#pragma once

#include "io/bytes/mesh_source.h"
#include "isoshell/polylines.h"

namespace isoshell {

Polylines read_obj_lines(const MeshSource& source);
Polylines read_ply_edges(const MeshSource& source);

}  // namespace isoshell
