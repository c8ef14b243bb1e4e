// PLY as a mesh, for readers that take it for something else where it is none.
#pragma once

#include "io/bytes/mesh_source.h"
#include "isoshell/surface_source.h"

namespace isoshell {

/// Throws as read_mesh() does.
TriangleSoup read_ply(const MeshSource& source);

/// As read_ply, but vertices of which no face makes a triangle are a result.
TriangleSoup read_ply_faces(const MeshSource& source);

}  // namespace isoshell
