// Which reader or writer a mesh file gets.
#include "isoshell/io/mesh_file.h"

#include <algorithm>
#include <new>

#include "core/attribute_values.h"
#include "io/mesh/mesh_readers.h"
#include "io/mesh/mesh_writers.h"
#include "isoshell/error.h"

namespace isoshell {
namespace {

MeshFormat format_of(const std::string& path, MeshFormat format, const char* stage) {
  if (format != MeshFormat::from_name) return format;
  if (path == "-") throw Error(ErrorCode::usage, stage, "a standard stream has no name to tell the format; name one");
  const size_t dot = path.rfind('.');
  std::string ending = dot == std::string::npos ? "" : path.substr(dot + 1);
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? char(c | 0x20) : c; });
  if (ending == "ply") return MeshFormat::ply;
  if (ending == "obj") return MeshFormat::obj;
  if (ending == "stl") return MeshFormat::stl;
  if (ending == "off") return MeshFormat::off;
  if (ending == "glb") return MeshFormat::glb;
  if (ending == "gltf") return MeshFormat::gltf;
  throw Error(ErrorCode::usage, stage,
              path +
                  ": the name does not tell the format; it must end in .ply, .obj, .stl, .off, .glb or .gltf, or name "
                  "a format");
}

}  // namespace

TriangleSoup read_mesh(const std::string& path, MeshFormat format) {
  format = format_of(path, format, "read_mesh");
  const MeshSource source(path);
  if (source.size() == 0) source.nothing_to_mesh("is empty (0 bytes); give a file with faces");
  try {
    switch (format) {
      case MeshFormat::ply:
        return read_ply(source);
      case MeshFormat::obj:
        return read_obj(source);
      case MeshFormat::stl:
        return read_stl(source);
      case MeshFormat::glb:
      case MeshFormat::gltf:
        return read_gltf(source);
      default:
        return read_off(source);
    }
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::out_of_memory, "read_mesh",
                source.name() + ": " + std::to_string(source.size()) + " bytes do not fit into memory as a mesh");
  }
}

void write_mesh(const std::string& path, const TriangleMesh& mesh, const MeshWriteOptions& options) {
  const MeshFormat format = format_of(path, options.format, "write_mesh");
  if (!mesh.gap.empty() && mesh.gap.size() != mesh.vertices.size())
    throw Error(ErrorCode::usage, "write_mesh", "the mesh has another number of gap flags than of vertices");
  for (const Attribute& a : mesh.attributes)
    if (const std::string misfit = misfit_of(a, mesh.vertices.size(), mesh.triangles.size()); !misfit.empty())
      throw Error(ErrorCode::usage, "write_mesh", misfit);
  OutputFile file(path, options.overwrite);
  switch (format) {
    case MeshFormat::ply:
      write_ply(file, mesh, options.curve_edges);
      break;
    case MeshFormat::obj:
      write_obj(file, mesh);
      break;
    case MeshFormat::stl:
      write_stl(file, mesh);
      break;
    case MeshFormat::glb:
      write_glb(file, mesh);
      break;
    case MeshFormat::gltf:
      write_gltf(file, mesh);
      break;
    default:
      write_off(file, mesh);
      break;
  }
  file.commit();
}

}  // namespace isoshell
