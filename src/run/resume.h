// The options of a run that goes on from a stage file.
#pragma once

#include <string>

#include "isoshell/io/vdb_file.h"
#include "isoshell/options/options_json.h"

namespace isoshell {

/// The options that were asked for, with the stage file's where none was given. Options that made what the file holds
/// may be given only as they were then. `path` is the file's.
/// Throws: usage, naming the option and its value there; unreadable_input when the kept options cannot be read.
RequestedOptions adopt_options(const StageFile& file, const std::string& path, const RequestedOptions& requested);

}  // namespace isoshell
