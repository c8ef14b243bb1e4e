// Where results go: checks before the run, so that hours of work do not end at a locked door.
#pragma once

#include <string>

#include "vdb_isomesh/args.h"

namespace isoshell::tool {

/// The picture of a Voronoi file for programs that open float grids only: mesh.voronoi.vdb has
/// mesh.voronoi.preview.vdb.
std::string preview_path(const std::string& path);

/// Every file that the run would write can be: its folder exists and is writable, and it does not exist yet unless
/// --force. Throws: unwritable_output, also when this build cannot write its format; usage when two results would share
/// one file.
void check_outputs(const Arguments& arguments);

/// Writes `text` to a file, under a temporary name and renamed, or to standard output for "-".
/// Throws: unwritable_output.
void write_text(const std::string& path, const std::string& text);

}  // namespace isoshell::tool
