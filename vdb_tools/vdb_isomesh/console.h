// Everything a person reads: messages and progress, all on standard error.
#pragma once

#include <chrono>
#include <string>

#include "vdb_isomesh/args.h"

namespace isoshell::tool {

/// Messages of one run. Errors always, warnings and results unless quiet, details when verbose. No colour unless
/// standard error is a terminal and NO_COLOR is not set.
class Console {
 public:
  /// Messages begin with the name of the program, which outlives the console.
  Console(ProgressMode progress, int verbosity, const char* program = "vdb_isomesh");
  ~Console() { clear_bar(); }

  void error(const std::string& message);
  void warn(const std::string& message);
  void result(const std::string& message);
  void detail(const std::string& message);

  /// A stage began (fraction 0), goes on, or is done (1). A bar on a terminal, lines of JSON with --progress json.
  void progress(const std::string& stage, double fraction);

 private:
  void print(const char* label, const char* colour, const std::string& message);
  void clear_bar();
  void draw_bar(const std::string& stage, double fraction);

  ProgressMode progress_;
  int verbosity_;
  const char* program_;
  bool colour_;
  bool bar_drawn_ = false;
  std::string last_stage_;
  double last_fraction_ = -1;
  std::chrono::steady_clock::time_point start_, last_drawn_;
};

}  // namespace isoshell::tool
