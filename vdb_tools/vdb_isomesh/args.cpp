// Parses and checks the command line. CLI11 does the splitting; every message is ours to keep readable.
#include "vdb_isomesh/args.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>
#include <type_traits>

#include "isoshell/error.h"
#include "isoshell/option_range.h"
#include "vdb_isomesh/help.h"

namespace isoshell::tool {
namespace {

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::usage, "command line", message); }

constexpr const char* kDescription =
    "vdb_isomesh INPUT OUTPUT [options]\n\n"
    "Turns any surface into an isotropic triangle mesh: closed, 2-manifold, well-shaped triangles.\n\n"
    "INPUT   a mesh (.obj .ply .stl .off), a point cloud (.ply .xyz .pcd), a volume (.vdb .nvdb;\n"
    "        FILE.vdb:NAME names a grid), or a stage file that this command wrote (.vdb); - reads\n"
    "        standard input and needs --input-format\n"
    "OUTPUT  a mesh (.ply .obj .stl .off), or a .vdb file with --stop-after; - writes standard output\n"
    "        and needs --output-format";

/// What CLI11 fills in before it is checked and turned into Arguments.
struct Raw {
  int64_t vertices = 0;
  double edge_length = 0, voxel_size = 0, tolerance = 0, step = 0, iso = 0, adaptivity = 0, gradation = 0;
  int64_t resolution = 0, band = 0, iterations = 0, threads = 0;
  std::string seed, close_gaps, method, fit, device, stop_after, require, max_memory, progress;
  bool verbose = false, quiet = false, help = false, version = false;
  std::vector<std::string> reals;  ///< options that take any number, not only whole ones
};

void describe(CLI::App& app, Arguments& a, Raw& raw) {
  app.set_help_flag();
  app.allow_extras();
  app.add_option("INPUT", a.input);
  app.add_option("OUTPUT", a.output);

  const auto option = [&](const char* group, const char* name, auto& value, const char* value_name, const char* text,
                          const char* fallback = "") {
    if (std::is_floating_point_v<std::decay_t<decltype(value)>>) raw.reals.push_back(name);
    return app.add_option(name, value, text)->group(group)->type_name(value_name)->default_str(fallback);
  };
  const auto flag = [&](const char* group, const char* name, bool& value, const char* text) {
    app.add_flag(name, value, text)->group(group)->type_name("");
  };

  const char* size = "Size of the result";
  CLI::Option* vertices = option(size, "--vertices", raw.vertices, "K", "number of vertices of the result", "10000");
  option(size, "--edge-length", raw.edge_length, "L", "target edge length in world units, instead of --vertices")
      ->excludes(vertices);
  option(size, "--sizing", a.sizing, "F.vdb[:GRID]",
         "float grid of target edge lengths in world units; without --vertices it also decides the number of vertices");
  option(size, "--adaptivity", raw.adaptivity, "A",
         "fraction of the vertices, 0 to 1, distributed by curvature instead of area", "0");
  option(size, "--gradation", raw.gradation, "G", "maximum ratio of neighbouring edge lengths, above 1 and at most 10",
         "1.2");

  const char* grid = "Grid";
  CLI::Option* resolution = option(grid, "--resolution", raw.resolution, "R",
                                   "voxels along the longest side, 8 to 8192", "cells are 4.5 to 5.5 voxels wide");
  option(grid, "--voxel-size", raw.voxel_size, "S", "voxel size in world units, instead of --resolution")
      ->excludes(resolution);
  option(grid, "--band", raw.band, "D", "thickness of the shell in voxels, 1 to 20", "2");
  option(grid, "--close-gaps", raw.close_gaps, "W",
         "maximum width of the gaps to bridge: W in world units, voxels as 4vox, 0, or auto", "auto");
  flag(grid, "--outer-only", a.remesh.outer_only, "drop what lies inside of closed surfaces (default: keep hollows)");

  const char* relaxation = "Relaxation";
  option(relaxation, "--method", raw.method, "sheet|shell",
         "sheet: exact clipped Voronoi cells on the closed sheet; shell: the paper's iteration on voxels of the shell",
         "sheet");
  option(relaxation, "--iterations", raw.iterations, "N",
         "maximum number of relaxation passes on the finest level of seeds", "the method's own");
  option(relaxation, "--tolerance", raw.tolerance, "E",
         "stop when the energy falls by less than this fraction per pass", "the method's own");
  option(relaxation, "--step", raw.step, "U", "maximum movement of a seed per pass, in voxels", "the method's own");
  option(relaxation, "--seed", raw.seed, "N", "seed of the random number generator", "0");

  const char* shape = "Shape of the result";
  option(shape, "--fit", raw.fit, "balanced|surface",
         "balanced: vertices where the mesh is closest to the surface; surface: vertices on the surface", "balanced");
  flag(shape, "--uniform-area", a.remesh.uniform_area, "prefer triangles of equal area to triangles of the best shape");

  const char* files = "Files";
  option(files, "--iso", raw.iso, "V", "isovalue of a volume; required for a fog volume", "0 in a level set");
  option(files, "--input-format", a.input_format, "F", "format of INPUT: obj, ply, stl, off, xyz, pcd, vdb or nvdb",
         "by its name");
  option(files, "--output-format", a.output_format, "F", "format of OUTPUT: ply, obj, stl, off or vdb", "by its name");
  option(files, "--save-shell", a.save_shell, "F.vdb", "also write the shell, to resume from");
  option(files, "--save-voronoi", a.save_voronoi, "F.vdb", "also write the Voronoi volume, to resume from");
  option(files, "--stop-after", raw.stop_after, "shell|voronoi", "stop after this stage; OUTPUT is its .vdb file");
  option(files, "--stats", a.stats, "F.json", "write all statistics as JSON; - writes to standard output");
  flag(files, "--force", a.force, "overwrite existing files");

  const char* run = "Run";
  option(run, "--require", raw.require, "LIST",
         "exit with status 6 unless the result meets every requirement of this comma-separated list: closed, manifold, "
         "no-self-intersections, genus=G, components=N, min-angle=DEG (smallest angle in degrees), max-deviation=W "
         "(distance between result and input in world units)");
  option(run, "--device", raw.device, "auto|cpu|cuda[:N]", "device to run on", "auto");
  option(run, "--threads", raw.threads, "N", "number of CPU threads", "all");
  option(run, "--max-memory", raw.max_memory, "SIZE",
         "refuse a run that would need more memory than this (of the device, for a run there), as 512M or 8G",
         "80 % of the free memory");
  flag(run, "--dry-run", a.dry_run, "print the grid and the memory estimate, and exit");
  option(run, "--progress", raw.progress, "auto|always|never|json", "report progress on standard error", "auto");
  flag(run, "-v,--verbose", raw.verbose, "print more messages");
  flag(run, "-q,--quiet", raw.quiet, "print errors only");
  flag(run, "-h,--help", raw.help, "print this help and exit");
  flag(run, "--version", raw.version, "print the version and exit");
}

template <class Value>
Value chosen(const std::string& option, const std::string& text,
             std::initializer_list<std::pair<const char*, Value>> choices) {
  std::string names;
  for (const auto& [name, value] : choices) {
    if (text == name) return value;
    names += names.empty() ? name : std::string(", ") + name;
  }
  refuse(option + " is '" + text + "'; it must be one of " + names);
}

double parse_number(const std::string& option, const std::string& text) {
  double value = 0;
  std::istringstream stream(text);
  stream.imbue(std::locale::classic());
  if (!(stream >> value) || !stream.eof() || !std::isfinite(value))
    refuse(option + " is '" + text + "'; it must be a number");
  return value;
}

int64_t parse_count(const std::string& option, const std::string& text) {
  const double value = parse_number(option, text);
  if (value != std::floor(value) || value < 0 || value > 1e15)
    refuse(option + " is '" + text + "'; it must be a whole number, 0 or more");
  return int64_t(value);
}

/// All 64 bits, which a double does not hold.
uint64_t parse_seed(const std::string& text) {
  uint64_t value = 0;
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (failed != std::errc() || end != text.data() + text.size())
    refuse("--seed is '" + text + "'; it must be a whole number, 0 to 18446744073709551615");
  return value;
}

void check_range(const std::string& option, double value, const OptionRange& range) {
  if (!range.holds(value)) refuse(range.refusal(option, value));
}

void set_gaps(const std::string& text, RemeshOptions& options) {
  if (text == "auto") return;
  const size_t unit = text.find("vox");
  const bool voxels = unit != std::string::npos && unit + 3 == text.size();
  const double width = parse_number("--close-gaps", voxels ? text.substr(0, unit) : text);
  if (width < 0) refuse("--close-gaps is " + text + "; a width is 0 or more");
  if (voxels) check_range("--close-gaps in voxels", width, {0, 2 * kMaxClosingVox});
  if (voxels || width == 0)
    options.closing_vox = int32_t(std::ceil(width / 2));
  else
    options.closing_world = width;
}

void set_device(const std::string& text, Arguments& a) {
  if (text.compare(0, 5, "cuda:") == 0) {
    a.backend = Backend::cuda;
    const int64_t number = parse_count("--device", text.substr(5));
    check_range("the device number", double(number), {0, 1023});
    a.device = int(number);
    return;
  }
  a.backend =
      chosen<Backend>("--device", text, {{"auto", Backend::best}, {"cpu", Backend::cpu}, {"cuda", Backend::cuda}});
}

void set_gate(const std::string& gate, Gates& gates) {
  const size_t equals = gate.find('=');
  const std::string name = gate.substr(0, equals);
  const std::string value = equals == std::string::npos ? "" : gate.substr(equals + 1);
  const bool has_value = equals != std::string::npos;
  if (name == "closed" && !has_value)
    gates.closed = true;
  else if (name == "manifold" && !has_value)
    gates.manifold = true;
  else if (name == "no-self-intersections" && !has_value)
    gates.no_self_intersections = true;
  else if (name == "genus" && has_value)
    gates.genus = parse_count("--require genus", value);
  else if (name == "components" && has_value)
    gates.components = parse_count("--require components", value);
  else if (name == "min-angle" && has_value) {
    gates.min_angle_deg = parse_number("--require min-angle", value);
    check_range("--require min-angle", *gates.min_angle_deg, {0, 60});
  } else if (name == "max-deviation" && has_value) {
    gates.max_deviation_world = parse_number("--require max-deviation", value);
    check_range("--require max-deviation", *gates.max_deviation_world, {});
  } else {
    refuse("--require has '" + gate +
           "'; gates are closed, manifold, no-self-intersections, genus=G, components=N, min-angle=DEG, "
           "max-deviation=W");
  }
}

std::string lower_extension(std::string format) {
  if (!format.empty() && format[0] == '.') format.erase(0, 1);
  std::transform(format.begin(), format.end(), format.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return format;
}

std::string extension_of(const std::string& path) {
  const size_t slash = path.find_last_of('/'), dot = path.find_last_of('.');
  return dot == std::string::npos || (slash != std::string::npos && dot < slash) ? ""
                                                                                 : lower_extension(path.substr(dot));
}

/// FILE.vdb:NAME and FILE.nvdb:NAME.
void split_off_grid(Arguments& a) {
  const size_t slash = a.input.find_last_of('/'), start = slash == std::string::npos ? 0 : slash;
  const size_t colon = a.input.find(".vdb:", start), nano_colon = a.input.find(".nvdb:", start);
  const size_t at = std::min(colon == std::string::npos ? colon : colon + 4,
                             nano_colon == std::string::npos ? nano_colon : nano_colon + 5);
  if (at == std::string::npos) return;
  a.grid = a.input.substr(at + 1);
  a.input.resize(at);
  if (a.grid.empty()) refuse("INPUT names no grid behind its colon");
}

[[noreturn]] void refuse_vdb_to_pipe() { refuse("a .vdb file cannot be written to standard output; name a file"); }

/// Formats by name or option; "-" has no name to go by.
void settle_formats(Arguments& a) {
  split_off_grid(a);
  a.input_format = lower_extension(a.input_format);
  a.output_format = lower_extension(a.output_format);
  if (a.input == "-" && a.input_format.empty()) refuse("INPUT is standard input; say what it holds by --input-format");
  if (a.output == "-" && a.output_format.empty())
    refuse("OUTPUT is standard output; say what to write by --output-format");
  if (a.input_format.empty()) a.input_format = extension_of(a.input);
  if (a.output_format.empty() && !a.output.empty()) a.output_format = extension_of(a.output);
  if (a.save_shell == "-" || a.save_voronoi == "-") refuse_vdb_to_pipe();
  if (a.output.empty()) return;
  if (a.stop_after == StopAfter::mesh) {
    chosen<int>("the format of OUTPUT", a.output_format, {{"ply", 0}, {"obj", 0}, {"stl", 0}, {"off", 0}});
  } else {
    if (a.output_format != "vdb") refuse("with --stop-after, OUTPUT is a .vdb file; it is '" + a.output + "'");
    if (a.output == "-") refuse_vdb_to_pipe();
  }
}

void settle(CLI::App& app, Arguments& a, const Raw& raw) {
  for (const CLI::Option* option : app.get_options())
    if (option->count() > 0 && !option->get_lnames().empty()) a.given.push_back(option->get_lnames()[0]);
  const auto ranged = [&](const char* name, double value, const OptionRange& range) {
    const bool given = a.was_given(name);
    if (given) check_range(std::string("--") + name, value, range);
    return given;
  };
  RemeshOptions& o = a.remesh;
  if (ranged("vertices", double(raw.vertices), option_range::vertices)) o.vertices = raw.vertices;
  if (ranged("edge-length", raw.edge_length, option_range::length)) o.edge_length_world = raw.edge_length;
  if (ranged("adaptivity", raw.adaptivity, option_range::adaptivity)) o.adaptivity = raw.adaptivity;
  if (ranged("gradation", raw.gradation, option_range::gradation)) o.gradation = raw.gradation;
  if (a.was_given("sizing") && a.sizing.empty()) refuse("--sizing needs the name of a .vdb file");
  if (!a.sizing.empty() && !a.was_given("vertices")) o.vertices = 0;
  if (ranged("resolution", double(raw.resolution), option_range::resolution)) o.resolution = int32_t(raw.resolution);
  if (ranged("voxel-size", raw.voxel_size, option_range::length)) o.voxel_size_world = raw.voxel_size;
  if (ranged("band", double(raw.band), option_range::band)) o.band_vox = int32_t(raw.band);
  if (ranged("iterations", double(raw.iterations), option_range::iterations)) o.max_passes = int32_t(raw.iterations);
  if (ranged("tolerance", raw.tolerance, option_range::tolerance)) o.tolerance = raw.tolerance;
  if (ranged("step", raw.step, option_range::step)) o.max_step_vox = raw.step;
  if (ranged("threads", double(raw.threads), {1, 4096})) a.threads = int(raw.threads);
  if (a.was_given("iso")) {
    if (!std::isfinite(raw.iso)) refuse("--iso must be a finite number");
    a.iso = raw.iso;
  }
  if (!raw.seed.empty()) o.seed = parse_seed(raw.seed);
  if (!raw.close_gaps.empty()) set_gaps(raw.close_gaps, o);
  if (!raw.method.empty())
    o.method = chosen<Method>("--method", raw.method, {{"sheet", Method::sheet}, {"shell", Method::shell}});
  check_method(o, a.sizing);
  if (!raw.fit.empty()) o.fit = chosen<Fit>("--fit", raw.fit, {{"balanced", Fit::balanced}, {"surface", Fit::surface}});
  if (!raw.device.empty()) set_device(raw.device, a);
  if (!raw.stop_after.empty())
    a.stop_after = chosen<StopAfter>("--stop-after", raw.stop_after,
                                     {{"shell", StopAfter::shell}, {"voronoi", StopAfter::voronoi}});
  if (!raw.progress.empty())
    a.progress = chosen<ProgressMode>("--progress", raw.progress,
                                      {{"auto", ProgressMode::automatic},
                                       {"always", ProgressMode::always},
                                       {"never", ProgressMode::never},
                                       {"json", ProgressMode::json}});
  if (!raw.max_memory.empty()) a.max_memory_bytes = parse_size_bytes(raw.max_memory);
  std::istringstream gates(raw.require);
  for (std::string gate; std::getline(gates, gate, ',');) set_gate(gate, a.gates);
  if (a.gates.any() && a.stop_after != StopAfter::mesh) refuse("--require needs a mesh; leave out --stop-after");
  if (raw.verbose && raw.quiet) refuse("--verbose and --quiet exclude each other");
  a.verbosity = raw.quiet ? 0 : raw.verbose ? 2 : 1;
}

void refuse_leftovers(const CLI::App& app) {
  for (const std::string& left : app.remaining()) {
    if (left.size() < 2 || left[0] != '-') continue;
    const std::string hint = closest_option(app, left);
    refuse("unknown option " + left + (hint.empty() ? "; see --help" : "; did you mean " + hint + "?"));
  }
  if (!app.remaining().empty())
    refuse("one argument too many: '" + app.remaining()[0] + "'; there is one INPUT and one OUTPUT");
}

}  // namespace

void check_method(const RemeshOptions& options, const std::string& sizing) {
  if (options.method == Method::shell && (!sizing.empty() || options.adaptivity > 0))
    refuse("--sizing and --adaptivity need --method sheet: the paper's loop on the shell has even cells");
}

bool Arguments::was_given(const std::string& option) const {
  return std::find(given.begin(), given.end(), option) != given.end();
}

int64_t parse_size_bytes(const std::string& text) {
  const size_t end = std::min(text.find_first_not_of("0123456789.+-eE"), text.size());
  const std::string unit = lower_extension(text.substr(end));
  const int64_t scale = chosen<int64_t>("the unit of a size", unit.empty() ? "bytes" : unit,
                                        {{"bytes", 1},
                                         {"b", 1},
                                         {"k", 1ll << 10},
                                         {"kb", 1ll << 10},
                                         {"kib", 1ll << 10},
                                         {"m", 1ll << 20},
                                         {"mb", 1ll << 20},
                                         {"mib", 1ll << 20},
                                         {"g", 1ll << 30},
                                         {"gb", 1ll << 30},
                                         {"gib", 1ll << 30},
                                         {"t", 1ll << 40},
                                         {"tb", 1ll << 40},
                                         {"tib", 1ll << 40}});
  const double bytes = parse_number("the size", text.substr(0, end)) * double(scale);
  if (!(bytes >= 1) || bytes > 9e18) refuse("the size '" + text + "' must be more than 0");
  return int64_t(bytes);
}

namespace {

/// CLI11 names neither the kind of number nor the remedy, and takes "-1" for the largest unsigned number.
[[noreturn]] void refuse_conversion(const CLI::ConversionError& e, const Raw& raw) {
  const std::string text = e.what();
  const size_t dashes = text.find("--"), equals = text.find(" = ");
  if (dashes == std::string::npos || equals == std::string::npos || equals < dashes) refuse(text + "; see --help");
  const std::string option = text.substr(dashes, equals - dashes);
  const bool real = std::find(raw.reals.begin(), raw.reals.end(), option) != raw.reals.end();
  refuse(option + " is '" + text.substr(equals + 3) + "'; it must be a " + (real ? "number" : "whole number"));
}

}  // namespace

CommandLine parse_command_line(int argc, const char* const* argv) {
  Arguments a;
  Raw raw;
  CLI::App app(kDescription);
  describe(app, a, raw);

  std::vector<std::string> words;  // backwards, as CLI11 wants them
  for (int i = argc - 1; i > 0; --i) {
    std::string word = argv[i];
    if (word == "-help" || word == "-version") word.insert(0, "-");
    words.push_back(word);
  }
  try {
    app.parse(words);
  } catch (const CLI::ConversionError& e) {
    refuse_conversion(e, raw);
  } catch (const CLI::ParseError& e) {
    refuse(std::string(e.what()) + "; see --help");
  }
  if (raw.help) return {std::nullopt, help_text(app)};
  if (raw.version) return {std::nullopt, version_text()};
  refuse_leftovers(app);
  settle(app, a, raw);
  if (a.input.empty()) refuse("INPUT is missing; see --help");
  if (a.output.empty() && !a.dry_run) refuse("OUTPUT is missing; see --help");
  settle_formats(a);
  if (a.output == "-" && a.stats == "-") refuse("OUTPUT and --stats cannot both be standard output");
  return {std::move(a), ""};
}

}  // namespace isoshell::tool
