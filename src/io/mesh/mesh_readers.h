// One reader a format. Each throws as read_mesh() does.
#pragma once

#include "io/bytes/mesh_source.h"
#include "isoshell/polylines.h"
#include "isoshell/surface_source.h"

namespace isoshell {

/// .glb as well as .gltf; buffers in files of their own are found from the source's name.
TriangleSoup read_gltf(const MeshSource& source);
TriangleSoup read_obj(const MeshSource& source);
TriangleSoup read_off(const MeshSource& source);
TriangleSoup read_ply(const MeshSource& source);
TriangleSoup read_stl(const MeshSource& source);

/// The lines of an OBJ file, the edges of a PLY file; each throws as read_polylines() does.
Polylines read_obj_lines(const MeshSource& source);
Polylines read_ply_edges(const MeshSource& source);

/// As read_ply, but vertices of which no face makes a triangle are a result.
TriangleSoup read_ply_faces(const MeshSource& source);

}  // namespace isoshell
