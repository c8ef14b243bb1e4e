// The options of a run that a stage file keeps, and those of a run that goes on from it.
#pragma once

#include <string>

#include "isoshell/io/vdb_file.h"
#include "isoshell/remesh.h"
#include "vdb_isomesh/args.h"

namespace isoshell::tool {

/// The options that a resumed run must repeat, to be kept in a stage file.
std::string options_json(const RemeshOptions& options);

/// Takes from a stage file the options that were not given on the command line, and returns where the sizing field is,
/// as
/// --sizing names it; empty: even edges. Options that made what the file holds may be given only as they were then.
/// Throws: usage, naming the option and its value there; unreadable_input when the kept options cannot be read.
std::string adopt_options(const StageFile& file, const Arguments& arguments, RemeshOptions& options);

}  // namespace isoshell::tool
