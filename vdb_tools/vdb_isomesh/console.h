// Everything a person reads: messages and progress, all on standard error.
#pragma once

#include <chrono>
#include <mutex>
#include <string>

#include "isoshell/message.h"
#include "vdb_isomesh/args.h"

namespace isoshell::tool {

/// Messages of one run. Errors always, warnings and results unless quiet, details when verbose. No colour unless
/// standard error is a terminal and NO_COLOR is not set.
class Console {
 public:
  /// Messages begin with the name of the program, which outlives the console.
  Console(ProgressMode progress, int verbosity, const char* program);
  ~Console() { clear_bar(); }

  void error(const std::string& message);
  void warn(const std::string& message);
  void result(const std::string& message);
  void detail(const std::string& message);

  /// A bar on a terminal, lines of JSON with --progress json. From any thread.
  void progress(const Progress& progress);

 private:
  void print(const char* label, const char* colour, const std::string& message);
  void clear_bar();
  void draw_bar(const Progress& progress);

  ProgressMode progress_;
  int verbosity_;
  const char* program_;
  bool colour_;
  std::mutex mutex_;  ///< of what is written
  bool bar_drawn_ = false;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace isoshell::tool
