// Parses and checks the command line.
#include "vdb_meshinfo/args.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <vector>

#include "isoshell/error.h"
#include "isoshell/io/file_format.h"
#include "isoshell/options/option_text.h"
#include "vdb_isomesh/help.h"

namespace isoshell::tool {
namespace {

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::usage, "command line", message); }

std::string description(const MeshInfoProgram& program) {
  return program.name +
         " MESH [--ref INPUT] [options]\n\n"
         "Counts and measures a triangle mesh as it is stored: topology, shapes of triangles, self-intersections,\n"
         "and with --ref how far it is from a surface, or points are from it.\n\n"
         "MESH    a mesh (" +
         listed_endings(reads_mesh) + "); - reads standard input and needs --input-format" +
         (program.also_reads.empty() ? "" : ";\n        " + program.also_reads);
}

constexpr const char* kExitStatus =
    "\nExit status: 0 done, 1 internal error, 2 wrong usage, 3 input cannot be read, 4 output cannot be\n"
    "written, 5 no triangle to measure, 6 a requirement of --require is not met, 7 over the memory limit\n"
    "or out of memory, 130 interrupted.\n";

struct Raw {
  std::string mesh, format, reference, reference_format, require, threads, max_memory;
  bool json = false, help = false, version = false;
};

void describe(CLI::App& app, MeshInfoArguments& a, Raw& raw) {
  app.set_help_flag();
  app.allow_extras();
  app.add_option("MESH", raw.mesh);
  const auto option = [&](const char* group, const char* name, std::string& value, const char* value_name,
                          const std::string& text, const char* fallback = "") {
    app.add_option(name, value, text)->group(group)->type_name(value_name)->default_str(fallback);
  };
  const auto flag = [&](const char* group, const char* name, bool& value, const char* text) {
    app.add_flag(name, value, text)->group(group)->type_name("");
  };
  const char* measure = "Measures";
  option(measure, "--ref", raw.reference, "INPUT",
         "also measure distances and deviations of normals from this surface, both ways: a mesh (" +
             listed_endings(reads_mesh) + ") or a volume (" + listed_endings(reads_volume) +
             "); or distances from the points of a cloud (" + listed_endings(reads_points) + ") to the mesh");
  option(measure, "--require", raw.require, "LIST",
         "exit with status 6 unless the mesh meets every requirement of this comma-separated list: " +
             listed_gates_of_meshes(true));
  const char* files = "Files";
  option(files, "--input-format", raw.format, "F", "format of MESH: " + listed_formats(reads_mesh), "by its name");
  option(files, "--ref-format", raw.reference_format, "F", "format of INPUT: " + listed_formats(reads_anything),
         "by its name");
  flag(files, "--json", raw.json, "write everything as JSON to standard output instead of the table");
  option(files, "--stats", a.statistics, "F.json", "write everything as JSON; - is --json");
  flag(files, "--force", a.overwrite, "overwrite an existing file");
  const char* process = "Run";
  option(process, "--threads", raw.threads, "N", "number of CPU threads", "all");
  option(process, "--max-memory", raw.max_memory, "SIZE", "refuse input that needs more memory, as 512M or 8G",
         "80 % of the free memory");
  flag(process, "-q,--quiet", a.quiet, "print errors only");
  flag(process, "-h,--help", raw.help, "print this help and exit");
  flag(process, "-V,--version", raw.version, "print the version and exit");
}

void refuse_leftovers(const CLI::App& app) {
  for (const std::string& left : app.remaining()) {
    if (left.size() < 2 || left[0] != '-') refuse("one argument too many: '" + left + "'; there is one MESH");
    const std::string hint = closest_option(app, left);
    refuse("unknown option " + left + (hint.empty() ? "; see --help" : "; did you mean " + hint + "?"));
  }
}

void refuse_empty_values(const CLI::App& app) {
  for (const CLI::Option* option : app.get_options())
    if (option->count() > 0 && option->results()[0].empty())
      refuse(option->get_name() + " has no value; give one, or leave it out");
}

}  // namespace

MeshInfoCommandLine parse_mesh_info(int argc, const char* const* argv, const MeshInfoProgram& program) {
  MeshInfoArguments a;
  Raw raw;
  CLI::App app(description(program));
  describe(app, a, raw);
  std::vector<std::string> words(argv + 1, argv + argc);
  std::reverse(words.begin(), words.end());  // as CLI11 wants them
  try {
    app.parse(std::move(words));
  } catch (const CLI::ParseError& e) {
    refuse(std::string(e.what()) + "; see --help");
  }
  if (raw.help) return {std::nullopt, options_text(app) + kExitStatus};
  if (raw.version) return {std::nullopt, version_text(program.name)};
  refuse_leftovers(app);
  refuse_empty_values(app);
  if (raw.mesh.empty()) refuse("MESH is missing; see --help");
  if (raw.mesh == "-" && raw.reference == "-") refuse("MESH and --ref cannot both be standard input");
  if (raw.json && !a.statistics.empty() && a.statistics != "-") refuse("--json and --stats exclude each other");
  if (raw.json) a.statistics = "-";
  a.request.mesh = named_input(raw.mesh, raw.format);
  if (!raw.reference.empty()) {
    a.request.reference = named_input(raw.reference, raw.reference_format);
    a.request.reference->keep_points = true;
  }
  a.request.gates = parse_gates(raw.require);
  if (!raw.threads.empty()) {
    const int64_t threads = parse_count("--threads", raw.threads);
    check_range("--threads", double(threads), {1, 4096});
    a.threads = int(threads);
  }
  if (!raw.max_memory.empty()) a.max_memory_bytes = parse_size_bytes(raw.max_memory);
  return {std::move(a), ""};
}

}  // namespace isoshell::tool
