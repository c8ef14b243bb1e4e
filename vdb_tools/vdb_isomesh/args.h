// The command line of vdb_isomesh: what was asked for, checked as far as it can be without looking at a file.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "isoshell/backend.h"
#include "isoshell/run/run.h"

namespace isoshell::tool {

enum class ProgressMode { automatic, always, never, json };

struct Arguments {
  RunRequest run;
  Backend backend = Backend::best;
  int device = 0;
  int threads = 0;
  int64_t max_memory_bytes = 0;  ///< 0 means by what is free
  bool dry_run = false;
  ProgressMode progress = ProgressMode::automatic;
  int verbosity = 1;  ///< 0 quiet, 1 warnings and results, 2 every stage
};

/// Either arguments to run with, or text that was asked for instead (--help, --version).
struct CommandLine {
  std::optional<Arguments> run;
  std::string text;
};

/// Throws: usage.
CommandLine parse_command_line(int argc, const char* const* argv);

}  // namespace isoshell::tool
