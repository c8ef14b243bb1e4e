// The whole command.
#pragma once

#include "vdb_isomesh/run.h"

namespace isoshell::tool {

/// What main does: runs the arguments, turns exceptions into the exit status that it returns. Signals end the process
/// from now on (answer_signals). Call it once in a process. Without `write_report` the option --report is refused.
int command(int argc, const char* const* argv, const WriteReport& write_report = {}, const Program& front = {});

}  // namespace isoshell::tool
