// The command line of vdb_isomesh: what was asked for, checked as far as it can be without looking at a file.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "isoshell/backend.h"
#include "isoshell/remesh.h"

namespace isoshell::tool {

enum class ProgressMode { automatic, always, never, json };
enum class StopAfter { mesh, shell, voronoi };

/// Conditions on the result; a run that misses one exits with 6.
struct Gates {
  bool closed = false, manifold = false, no_self_intersections = false;
  std::optional<int64_t> genus, components;
  std::optional<double> min_angle_deg, max_deviation_world;

  bool any() const {
    return closed || manifold || no_self_intersections || genus || components || min_angle_deg || max_deviation_world;
  }
};

struct Arguments {
  std::string input, output;
  std::string grid;  ///< of INPUT given as FILE.vdb:NAME
  std::optional<double> iso;
  std::string input_format, output_format;  ///< lower case, without a dot; empty means by the name
  RemeshOptions remesh;
  std::vector<std::string> given;  ///< long names of the options that were given, without dashes
  std::string save_shell, save_voronoi, stats;
  std::string sizing;  ///< FILE.vdb[:grid]; empty: even edges
  StopAfter stop_after = StopAfter::mesh;
  Gates gates;
  Backend backend = Backend::best;
  int device = 0;
  int threads = 0;
  int64_t max_memory_bytes = 0;  ///< 0 means by what is free
  bool dry_run = false, force = false;
  ProgressMode progress = ProgressMode::automatic;
  int verbosity = 1;  ///< 0 quiet, 1 warnings and results, 2 every stage

  bool was_given(const std::string& option) const;
};

/// Either arguments to run with, or text that was asked for instead (--help, --version).
struct CommandLine {
  std::optional<Arguments> run;
  std::string text;
};

/// Throws: usage.
CommandLine parse_command_line(int argc, const char* const* argv);

/// The paper's loop has even cells: refused with a sizing field or adaptivity. Throws: usage.
void check_method(const RemeshOptions& options, const std::string& sizing);

/// Bytes of "2G", "512M", "1.5k", "4GiB" or plain bytes. Throws: usage.
int64_t parse_size_bytes(const std::string& text);

}  // namespace isoshell::tool
