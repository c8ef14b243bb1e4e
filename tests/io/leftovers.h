// Temporary files as processes that were killed leave them.
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <string>

#include "io/bytes/temporary_name.h"

namespace isoshell {

/// That of a process which has ended.
inline pid_t ended_process() {
  const pid_t process = fork();
  if (process == 0) _exit(0);
  waitpid(process, nullptr, 0);
  return process;
}

/// A name of ours with another number of a process.
inline std::string temporary_of(const std::string& process) {
  std::string name = next_temporary_name();
  const std::string own = "-" + std::to_string(getpid()) + "-";
  return name.replace(name.rfind(own), own.size(), "-" + process + "-");
}

}  // namespace isoshell
