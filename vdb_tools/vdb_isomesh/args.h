// The command line of vdb_isomesh: what was asked for, checked as far as it can be without looking at a file.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "isoshell/backend.h"
#include "isoshell/options/option_range.h"
#include "isoshell/run/sequence.h"

namespace isoshell::tool {

enum class ProgressMode { automatic, always, never, json };

struct Arguments {
  RunRequest run;
  Backend backend = Backend::best;
  int device = 0;
  int threads = 0;
  int64_t max_memory_bytes = 0;  ///< 0 means by what is free
  bool dry_run = false;
  std::optional<FrameRange> frames;  ///< of a sequence, whose paths are patterns
  std::string velocity;
  bool is_coherent = true, keep_going = false, resume = false;
  ProgressMode progress = ProgressMode::automatic;
  int verbosity = 1;  ///< 0 quiet, 1 warnings and results, 2 every stage
};

/// Either arguments to run with, or text that was asked for instead (--help, --version).
struct CommandLine {
  std::optional<Arguments> run;
  std::string text;
};

/// What runs the command: the name by which people called it, and what it reads and writes beside the command's own
/// files, as the help says it.
struct Program {
  std::string name = "vdb_isomesh";
  std::string also_reads = {}, also_writes = {};
};

/// Throws: usage.
CommandLine parse_command_line(int argc, const char* const* argv, const Program& program = {});

/// An option by its name without dashes; a flag has no value.
struct GivenOption {
  std::string name;
  std::optional<std::string> value;
};
/// The same from a front that has names and values, and perhaps no file: `output` may be empty, and of the input only
/// its format and how it is read are set. Throws: usage.
Arguments parse_given_options(const std::vector<GivenOption>& given, const std::string& output);

/// A row of the table that the guide, --help and the Python module's keywords are made from.
struct OptionEntry {
  std::string group, name;
  std::string value;  ///< what stands for it, as K; empty: a flag
  std::string text;
  std::string fallback = {};  ///< what holds without the option, for people
  bool real = false;          ///< takes any number, not only whole ones
  bool of_command = false;    ///< means nothing to a front that calls the library
  OptionRange range = {};     ///< of a number
  bool repeats = false;       ///< its text has a line for each time that it is given
};
std::vector<OptionEntry> option_table();

}  // namespace isoshell::tool
