// Meshes from files and to files, whatever their format.
#include "isoshell/io/mesh_file.h"

#include <new>

#include "core/attribute_values.h"
#include "core/file_format.h"
#include "io/file_formats.h"
#include "isoshell/error.h"

namespace isoshell {
namespace {

const FormatRow& row_of(const std::string& path, const std::string& format, bool (*is_one)(const FileFormat&),
                        const char* stage) {
  if (format.empty() && path == "-")
    throw Error(ErrorCode::usage, stage, "a standard stream has no name to tell the format; name one");
  const FormatRow* row = find_row(format.empty() ? format_of_path(path) : format_name(format));
  if (row && is_one(row->format)) return *row;
  throw Error(ErrorCode::usage, stage,
              path + (format.empty() ? ": the name does not tell the format; it must end in one of " +
                                           listed_endings(is_one) + ", or name a format"
                                     : ": the format '" + format + "' must be one of " + listed_formats(is_one)));
}

}  // namespace

TriangleSoup read_mesh(const std::string& path, const std::string& format) {
  const FormatRow& row = row_of(path, format, reads_mesh, "read_mesh");
  const MeshSource source(path);
  if (source.size() == 0) source.nothing_to_mesh("is empty (0 bytes); give a file with faces");
  try {
    return row.read(source);
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::out_of_memory, "read_mesh",
                source.name() + ": " + std::to_string(source.size()) + " bytes do not fit into memory as a mesh");
  }
}

void write_mesh(const std::string& path, const TriangleMesh& mesh, const MeshWriteOptions& options) {
  const FormatRow& row = row_of(path, options.format, writes_mesh, "write_mesh");
  if (!mesh.gap.empty() && mesh.gap.size() != mesh.vertices.size())
    throw Error(ErrorCode::usage, "write_mesh", "the mesh has another number of gap flags than of vertices");
  if (!mesh.regions.empty() && mesh.regions.labels.size() != mesh.triangles.size())
    throw Error(ErrorCode::usage, "write_mesh", "the mesh has regions of another number of faces than it has");
  for (const Attribute& a : mesh.attributes)
    if (const std::string misfit = misfit_of(a, mesh.vertices.size(), mesh.triangles.size()); !misfit.empty())
      throw Error(ErrorCode::usage, "write_mesh", misfit);
  OutputFile file(path, options.overwrite);
  row.write(file, mesh, options);
  file.commit();
}

}  // namespace isoshell
