// The whole command.
#pragma once

#include <string>

namespace isoshell::tool {

/// What main does: runs the arguments, turns exceptions into the exit status that it returns. Messages and help call
/// the command `front`. Signals end the process from now on (answer_signals). Call it once in a process.
int mesh_info_command(int argc, const char* const* argv, const std::string& front = "vdb_meshinfo");

}  // namespace isoshell::tool
