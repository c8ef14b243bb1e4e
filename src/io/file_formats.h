// What of a format stays inside the library: its reader and its writer.
#pragma once

#include "io/bytes/mesh_source.h"
#include "io/bytes/output_file.h"
#include "io/mesh/precision.h"
#include "isoshell/io/file_format.h"
#include "isoshell/io/mesh_file.h"
#include "isoshell/io/point_file.h"

namespace isoshell {

/// What a format cannot do is null.
struct FormatRow {
  FileFormat format;
  TriangleSoup (*read)(const MeshSource& source) = nullptr;       ///< throws as read_mesh() does
  PointCloud (*read_points)(const MeshSource& source) = nullptr;  ///< throws as read_points() does; not yet finite
  void (*write)(OutputFile& file, const TriangleMesh& mesh, const Placement& placement,
                const MeshWriteOptions& options) = nullptr;
  /// In which numbers a mesh less an offset is written.
  Placement (*place)(const TriangleMesh& mesh, const WorldPoint& offset) = nullptr;
  std::string (*lacks)(const Attribute& attribute) = nullptr;  ///< why_not_held(), of what can be written
};

/// Null for a name that is none of a format.
const FormatRow* find_row(const std::string& name);

}  // namespace isoshell
