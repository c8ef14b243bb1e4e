// What INPUT is, by its format and its first bytes.
#pragma once

#include <string>

#include "isoshell/io/mesh_file.h"

namespace isoshell::tool {

enum class InputKind {
  mesh,
  points,
  ply,  ///< a mesh or points: only reading it tells
  volume,
  stage
};

const char* kind_name(InputKind kind);

/// `format` as in Arguments::input_format. Throws: unreadable_input when the file is missing or of no known kind.
InputKind classify_input(const std::string& path, const std::string& format);

/// The library's name of a mesh format; from_name for others.
MeshFormat mesh_format(const std::string& format);

}  // namespace isoshell::tool
