// The whole command.
#pragma once

namespace isoshell::tool {

/// What main does: runs the arguments, turns exceptions into the exit status that it returns. Signals end the process
/// from now on (answer_signals). Call it once in a process.
int command(int argc, const char* const* argv);

}  // namespace isoshell::tool
