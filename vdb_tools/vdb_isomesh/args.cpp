// Parses and checks the command line. CLI11 does the splitting; every message is ours to keep readable.
#include "vdb_isomesh/args.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <type_traits>

#include "isoshell/error.h"
#include "isoshell/run/option_text.h"
#include "vdb_isomesh/help.h"

namespace isoshell::tool {
namespace {

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::usage, "command line", message); }

constexpr const char* kDescription =
    "vdb_isomesh INPUT OUTPUT [options]\n\n"
    "Turns any surface into an isotropic triangle mesh: closed, 2-manifold, well-shaped triangles.\n\n"
    "INPUT   a mesh (.obj .ply .stl .off .glb .gltf), a point cloud (.ply .xyz .pcd), a volume (.vdb\n"
    "        .nvdb: a level set, unsigned distances, or with --iso a fog volume; FILE.vdb:NAME names a\n"
    "        grid), or a stage file that this command wrote (.vdb); - reads standard input and needs\n"
    "        --input-format\n"
    "OUTPUT  a mesh (.ply .obj .stl .off .glb .gltf), or a .vdb file with --stop-after; - writes standard\n"
    "        output and needs --output-format";

/// What CLI11 fills in before it is checked and turned into Arguments.
struct Raw {
  int64_t vertices = 0;
  double edge_length = 0, voxel_size = 0, tolerance = 0, step = 0, iso = 0, adaptivity = 0, gradation = 0;
  int64_t resolution = 0, band = 0, iterations = 0, threads = 0;
  std::string input, input_format, output, output_format;
  bool no_coherence = false, allow_intersections = false, verbose = false, quiet = false, help = false, version = false;
  std::string seed, close_gaps, method, fit, features, boundary, attributes, device, stop_after, require, max_memory,
      progress, frames;
  std::vector<std::string> reals;  ///< options that take any number, not only whole ones
};

void describe(CLI::App& app, Arguments& a, Raw& raw) {
  RunRequest& run = a.run;
  RemeshOptions& values = run.options.values;
  app.set_help_flag();
  app.allow_extras();
  app.add_option("INPUT", raw.input);
  app.add_option("OUTPUT", raw.output);

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
  option(size, "--sizing", run.options.sizing, "F.vdb[:GRID]",
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
  flag(grid, "--outer-only", values.outer_only, "drop what lies inside of closed surfaces (default: keep hollows)");

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
  option(shape, "--features", raw.features, "auto|off|DEG[,FILE]",
         "sharp edges of the input that stay: auto: those of crisp parts; DEG: all whose faces turn by so many degrees "
         "or more; off: none; and the lines of FILE, OBJ (l) or PLY (edges), as auto,curves.obj",
         "auto");
  option(shape, "--boundary", raw.boundary, "close|keep",
         "borders of a surface that is not closed: close: the result is closed; keep: those wider than the gaps of "
         "--close-gaps are borders of the result",
         "close");
  option(shape, "--attributes", raw.attributes, "all|none|LIST",
         "what a mesh has beside its positions and the result keeps: names separated by commas, such as color, uv, "
         "normal, material, group",
         "all");
  flag(shape, "--color-features", values.color_features,
       "colour faces by patch and vertices by curve and corner, and write the edges of curves; in PLY");
  flag(shape, "--uniform-area", values.uniform_area, "prefer triangles of equal area to triangles of the best shape");

  const char* files = "Files";
  option(files, "--iso", raw.iso, "V", "isovalue of a volume; required for a fog volume",
         "0 in a level set and in unsigned distances");
  option(files, "--input-format", raw.input_format, "F",
         "format of INPUT: obj, ply, stl, off, glb, gltf, xyz, pcd, vdb or nvdb", "by its name");
  option(files, "--output-format", raw.output_format, "F", "format of OUTPUT: ply, obj, stl, off, glb, gltf or vdb",
         "by its name");
  option(files, "--save-shell", run.save_shell, "F.vdb", "also write the shell, to resume from");
  option(files, "--save-voronoi", run.save_voronoi, "F.vdb", "also write the Voronoi volume, to resume from");
  option(files, "--stop-after", raw.stop_after, "shell|voronoi", "stop after this stage; OUTPUT is its .vdb file");
  option(files, "--stats", run.statistics, "F.json", "write all statistics as JSON; - writes to standard output");
  option(files, "--report", run.report, "F.html",
         "also write a page that shows the result beside the input, with all that was measured; by the Python module "
         "alone: pip install isoshell[report]");
  flag(files, "--force", run.overwrite, "overwrite existing files");

  const char* sequence = "Sequences";
  option(sequence, "--frames", raw.frames, "A-B[xSTEP]",
         "mesh the frames from A to B, every STEP-th, each beginning with the one before, so that vertices keep their "
         "numbers; INPUT, OUTPUT and --stats have #### or %04d where the number is");
  option(
      sequence, "--velocity", a.velocity, "GRID",
      "grid of velocities in the .vdb file of a frame, in world units a frame: where its surface goes until the next");
  flag(sequence, "--no-coherence", raw.no_coherence, "begin every frame anew");
  flag(sequence, "--keep-going", a.keep_going, "go on after a frame that cannot be read or meshed, or misses a gate");
  flag(sequence, "--resume", a.resume, "leave out the frames whose OUTPUT is there, and go on after them; in PLY");

  const char* process = "Run";
  option(process, "--require", raw.require, "LIST",
         "exit with status 6 unless the result meets every requirement of this comma-separated list: closed, manifold, "
         "no-self-intersections, genus=G, components=N, boundary-loops=N, min-angle=DEG (smallest angle in degrees), "
         "max-deviation=W (distance between result and input in world units), normal-deviation=DEG (mean angle between "
         "normals of result and input), features (no curve of the input is lost), kept-edges=PERCENT and born=N (of a "
         "frame "
         "that follows another: edges that it keeps, at least, and vertices that are new, at most)");
  flag(process, "--allow-intersections", raw.allow_intersections,
       "exit with status 0, not 6, where the result intersects itself");
  option(process, "--device", raw.device, "auto|cpu|cuda[:N]", "device to run on", "auto");
  option(process, "--threads", raw.threads, "N", "number of CPU threads", "all");
  option(process, "--max-memory", raw.max_memory, "SIZE",
         "refuse a run that would need more memory than this (of the device, for a run there), as 512M or 8G",
         "80 % of the free memory");
  flag(process, "--dry-run", a.dry_run, "print the grid and the memory estimate, and exit");
  option(process, "--progress", raw.progress, "auto|always|never|json", "report progress on standard error", "auto");
  flag(process, "-v,--verbose", raw.verbose, "print more messages");
  flag(process, "-q,--quiet", raw.quiet, "print errors only");
  flag(process, "-h,--help", raw.help, "print this help and exit");
  flag(process, "--version", raw.version, "print the version and exit");
}

/// All 64 bits, which a double does not hold.
uint64_t parse_seed(const std::string& text) {
  uint64_t value = 0;
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (failed != std::errc() || end != text.data() + text.size())
    refuse("--seed is '" + text + "'; it must be a whole number, 0 to 18446744073709551615");
  return value;
}

void set_device(const std::string& text, Arguments& a) {
  if (text.compare(0, 5, "cuda:") == 0) {
    a.backend = Backend::cuda;
    const int64_t number = parse_count("--device", text.substr(5));
    check_range("the device number", double(number), {0, 1023});
    a.device = int(number);
    return;
  }
  a.backend = parse_choice<Backend>("--device", text,
                                    {{"auto", Backend::best}, {"cpu", Backend::cpu}, {"cuda", Backend::cuda}});
}

void settle_options(const Raw& raw, AskedOptions& asked) {
  const auto ranged = [&](const char* name, double value, const OptionRange& range) {
    const bool given = asked.was_given(name);
    if (given) check_range(std::string("--") + name, value, range);
    return given;
  };
  RemeshOptions& o = asked.values;
  if (ranged("vertices", double(raw.vertices), option_range::vertices)) o.vertices = raw.vertices;
  if (ranged("edge-length", raw.edge_length, option_range::length)) o.edge_length_world = raw.edge_length;
  if (ranged("adaptivity", raw.adaptivity, option_range::adaptivity)) o.adaptivity = raw.adaptivity;
  if (ranged("gradation", raw.gradation, option_range::gradation)) o.gradation = raw.gradation;
  if (asked.was_given("sizing") && asked.sizing.empty()) refuse("--sizing needs the name of a .vdb file");
  if (ranged("resolution", double(raw.resolution), option_range::resolution)) o.resolution = int32_t(raw.resolution);
  if (ranged("voxel-size", raw.voxel_size, option_range::length)) o.voxel_size_world = raw.voxel_size;
  if (ranged("band", double(raw.band), option_range::band)) o.band_vox = int32_t(raw.band);
  if (ranged("iterations", double(raw.iterations), option_range::iterations)) o.max_passes = int32_t(raw.iterations);
  if (ranged("tolerance", raw.tolerance, option_range::tolerance)) o.tolerance = raw.tolerance;
  if (ranged("step", raw.step, option_range::step)) o.max_step_vox = raw.step;
  if (!raw.seed.empty()) o.seed = parse_seed(raw.seed);
  if (!raw.close_gaps.empty()) set_gap_width("--close-gaps", raw.close_gaps, o);
  if (!raw.method.empty()) o.method = parse_method("--method", raw.method);
  if (!raw.features.empty()) o.features = parse_features("--features", raw.features);
  if (!raw.boundary.empty()) o.boundary = parse_boundary("--boundary", raw.boundary);
  if (asked.was_given("attributes")) o.attributes = parse_attributes("--attributes", raw.attributes);
  check_method(asked);
  if (!raw.fit.empty()) o.fit = parse_fit("--fit", raw.fit);
}

void settle_sequence(const Raw& raw, Arguments& a) {
  if (!raw.frames.empty()) a.frames = parse_frames(raw.frames);
  a.is_coherent = !raw.no_coherence;
  for (const char* name : {"velocity", "no-coherence", "keep-going", "resume"})
    if (!a.frames && a.run.options.was_given(name)) refuse(std::string("--") + name + " needs --frames");
}

/// All but where the run reads from, which a front may have in memory.
void settle(const CLI::App& app, Arguments& a, const Raw& raw) {
  RunRequest& run = a.run;
  for (const CLI::Option* option : app.get_options())
    if (option->count() > 0 && !option->get_lnames().empty()) run.options.given.push_back(option->get_lnames()[0]);
  settle_options(raw, run.options);
  if (run.options.was_given("threads")) {
    check_range("--threads", double(raw.threads), {1, 4096});
    a.threads = int(raw.threads);
  }
  if (run.options.was_given("iso") && !std::isfinite(raw.iso)) refuse("--iso must be a finite number");
  if (!raw.device.empty()) set_device(raw.device, a);
  if (!raw.stop_after.empty())
    run.stop_after = parse_choice<StopAfter>("--stop-after", raw.stop_after,
                                             {{"shell", StopAfter::shell}, {"voronoi", StopAfter::voronoi}});
  if (!raw.progress.empty())
    a.progress = parse_choice<ProgressMode>("--progress", raw.progress,
                                            {{"auto", ProgressMode::automatic},
                                             {"always", ProgressMode::always},
                                             {"never", ProgressMode::never},
                                             {"json", ProgressMode::json}});
  if (!raw.max_memory.empty()) a.max_memory_bytes = parse_size_bytes(raw.max_memory);
  run.gates = parse_gates(raw.require);
  run.gates.allow_intersections = raw.allow_intersections;
  settle_sequence(raw, a);
  if (raw.verbose && raw.quiet) refuse("--verbose and --quiet exclude each other");
  a.verbosity = raw.quiet ? 0 : raw.verbose ? 2 : 1;
  if (a.verbosity == 0) run.measures = Measures::none;
  run.output = {raw.output, raw.output_format};
  check_request(run);
  run.output = named_output(raw.output, raw.output_format, run.stop_after);
  run.input.format = raw.input_format;
  if (run.options.was_given("iso")) run.input.iso = raw.iso;
}

void settle_input(RunRequest& run, const std::string& name) {
  const std::optional<double> iso = run.input.iso;
  run.input = named_input(name, run.input.format);
  run.input.iso = iso;
}

void refuse_leftovers(const CLI::App& app) {
  for (const std::string& left : app.remaining()) {
    if (left.size() < 2 || left[0] != '-') continue;
    const std::string hint = closest_option(app, left);
    refuse("unknown option " + left + (hint.empty() ? "; see --help" : "; did you mean " + hint + "?"));
  }
  if (!app.remaining().empty())
    refuse("one argument too many: '" + app.remaining()[0] +
           "'; there is one INPUT and one OUTPUT, which are patterns as 'mesh.####.ply' with --frames");
}

/// CLI11 names neither the kind of number nor the remedy, and takes "-1" for the largest unsigned number.
[[noreturn]] void refuse_conversion(const CLI::ConversionError& e, const Raw& raw) {
  const std::string text = e.what();
  const size_t dashes = text.find("--"), equals = text.find(" = ");
  if (dashes == std::string::npos || equals == std::string::npos || equals < dashes) refuse(text + "; see --help");
  const std::string option = text.substr(dashes, equals - dashes);
  const bool real = std::find(raw.reals.begin(), raw.reals.end(), option) != raw.reals.end();
  refuse(option + " is '" + text.substr(equals + 3) + "'; it must be a " + (real ? "number" : "whole number"));
}

/// `words` are backwards, as CLI11 wants them.
void split(CLI::App& app, std::vector<std::string> words, const Raw& raw) {
  try {
    app.parse(std::move(words));
  } catch (const CLI::ConversionError& e) {
    refuse_conversion(e, raw);
  } catch (const CLI::ParseError& e) {
    refuse(std::string(e.what()) + "; see --help");
  }
}

}  // namespace

CommandLine parse_command_line(int argc, const char* const* argv) {
  Arguments a;
  Raw raw;
  CLI::App app(kDescription);
  describe(app, a, raw);

  std::vector<std::string> words;
  for (int i = argc - 1; i > 0; --i) {
    std::string word = argv[i];
    if (word == "-help" || word == "-version") word.insert(0, "-");
    words.push_back(word);
  }
  split(app, std::move(words), raw);
  if (raw.help) return {std::nullopt, help_text(app)};
  if (raw.version) return {std::nullopt, version_text()};
  refuse_leftovers(app);
  settle(app, a, raw);
  if (raw.input.empty()) refuse("INPUT is missing; see --help");
  if (raw.output.empty() && !a.dry_run) refuse("OUTPUT is missing; see --help");
  settle_input(a.run, raw.input);
  return {std::move(a), ""};
}

Arguments parse_given_options(const std::vector<GivenOption>& given, const std::string& output) {
  Arguments a;
  Raw raw;
  CLI::App app(kDescription);
  describe(app, a, raw);

  std::vector<std::string> words;
  for (const GivenOption& option : given)
    words.push_back("--" + option.name + (option.value ? "=" + *option.value : ""));
  split(app, std::move(words), raw);
  refuse_leftovers(app);
  raw.output = output;
  settle(app, a, raw);
  return a;
}

std::vector<OptionEntry> option_table() {
  Arguments a;
  Raw raw;
  CLI::App app;
  describe(app, a, raw);
  std::vector<OptionEntry> table;
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_lnames().empty()) continue;
    const bool real = std::count(raw.reals.begin(), raw.reals.end(), option->get_name()) > 0;
    table.push_back({option->get_group(), option->get_lnames()[0], option->get_type_name(), option->get_description(),
                     option->get_default_str(), real});
  }
  return table;
}

}  // namespace isoshell::tool
