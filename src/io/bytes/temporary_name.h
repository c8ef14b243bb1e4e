// Names of files that are being written.
#pragma once

#include <string>

namespace isoshell {

/// ".isoshell-HOST-PID-N.tmp", another one each time: of a length of its own, so that a target with the longest legal
/// name can be written too.
std::string next_temporary_name();

/// Removes files of such names whose process on this host has ended without its own doing, as by SIGKILL. Those of
/// other hosts and of processes that live stay, and so do files that something still holds a lock on, as does
/// OutputFile: the process may be of a container with numbers of its own. What cannot be read or removed stays.
void remove_leftovers(const std::string& folder);

}  // namespace isoshell
