// Which reader or writer a mesh file gets.
#include "isoshell/io/mesh_file.h"

#include "isoshell/error.h"

namespace isoshell {

TriangleSoup read_mesh(const std::string&, MeshFormat) {
  throw Error(ErrorCode::internal, "mesh_file", "read_mesh is missing");
}

void write_mesh(const std::string&, const TriangleMesh&, const MeshWriteOptions&) {
  throw Error(ErrorCode::internal, "mesh_file", "write_mesh is missing");
}

}  // namespace isoshell
