// Several level sets of .vdb and .nvdb files.
#pragma once

#include "implicit/level_sets/level_sets.h"
#include "io/bytes/mesh_source.h"
#include "isoshell/io/input.h"

namespace isoshell {

/// Whether a request is for several level sets: it names more than one file, or its grid has * or ? in its name.
bool is_for_level_sets(const InputRequest& request);

/// Whether a name is of a pattern, in which * stands for any letters and ? for one.
bool fits(const std::string& name, const std::string& pattern);

/// A file of the request, with what it names.
struct LevelSetFile {
  const MeshSource* source;
  std::string grid;  ///< as InputRequest::grid
};

/// Reads the level sets that the files name, in their order, and those of a pattern by their names. A region has the
/// name of its grid, or FILE:GRID where that of another one is the same, with the path of the file where files have one
/// name in two folders. Each is held as blocks before the next one is read. They need the bytes of the files. Throws:
/// usage where a pattern fits no level set, or one with a flaw, for a grid that is given twice, and for files of other
/// formats; out_of_memory over the limit, of which the reference takes `reference_bytes`; and as read_vdb_volume() and
/// add_level_set() do.
LevelSets read_level_sets(const std::vector<LevelSetFile>& files, int64_t memory_limit_bytes,
                          int64_t reference_bytes = 0);

}  // namespace isoshell
