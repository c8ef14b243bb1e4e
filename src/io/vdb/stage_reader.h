// Stage files as bytes in memory, whatever they came from.
#pragma once

#include "io/bytes/mesh_source.h"
#include "isoshell/io/vdb_file.h"

namespace isoshell {

/// is_stage_file() of bytes in memory; the first vdb_format::kMaxHeaderBytes of them are enough.
bool holds_stage(View<const char> bytes);

/// read_stage() of bytes that are in memory. Throws: as it does.
StageFile read_stage(const MeshSource& source);

}  // namespace isoshell
