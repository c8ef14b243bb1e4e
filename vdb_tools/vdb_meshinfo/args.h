// The command line of vdb_meshinfo.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "isoshell/run/mesh_info.h"

namespace isoshell::tool {

struct MeshInfoArguments {
  MeshInfoRequest request;
  std::string statistics;  ///< file, or "-"; empty: none
  bool overwrite = false;
  int threads = 0;
  int64_t max_memory_bytes = 0;  ///< 0 means by what is free
  bool quiet = false;
};

/// Either arguments, or text that was asked for instead (--help, --version).
struct MeshInfoCommandLine {
  std::optional<MeshInfoArguments> arguments;
  std::string text;
};

/// What runs the command.
struct MeshInfoProgram {
  std::string name = "vdb_meshinfo";  ///< as messages and help call it
  std::string also_reads = {};        ///< of the help: files that it reads beside those of the library
};

/// Throws: usage.
MeshInfoCommandLine parse_mesh_info(int argc, const char* const* argv, const MeshInfoProgram& program = {});

}  // namespace isoshell::tool
