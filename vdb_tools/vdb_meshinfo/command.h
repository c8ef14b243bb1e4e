// The whole command.
#pragma once

#include <functional>
#include <optional>

#include "isoshell/backend.h"
#include "isoshell/io/input.h"
#include "vdb_meshinfo/args.h"

namespace isoshell::tool {

/// Reads a file whose format the library does not have; nothing where nobody else has it.
using ReadOther = std::function<std::optional<Input>(const InputRequest& request, Context& context, const Tell& tell)>;

/// What main does: runs the arguments, turns exceptions into the exit status that it returns. Signals end the process
/// from now on (answer_signals). Call it once in a process.
int mesh_info_command(int argc, const char* const* argv, const ReadOther& read_other = {},
                      const MeshInfoProgram& front = {});

}  // namespace isoshell::tool
