#include "vdb_isomesh/options.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <sstream>

#include "isoshell/error.h"
#include "isoshell/io/file_format.h"
#include "isoshell/options/option_table.h"
#include "isoshell/options/option_text.h"

namespace isoshell::tool {
namespace {

using Set = std::function<void(const std::string&, Arguments&)>;

void set_iso(const std::string& text, Arguments& a) {
  const double value = parse_real("--iso", text);
  if (!std::isfinite(value)) throw Error(ErrorCode::usage, "command line", "--iso must be a finite number");
  a.run.input.iso = value;
}

constexpr OptionRange kLabels{double(std::numeric_limits<int32_t>::min()), double(std::numeric_limits<int32_t>::max())};
constexpr OptionRange kIslands{0, kLabels.high}, kSmoothing{0, 1}, kLevelSetBand{1, kMaxLevelSetBandVox};

void set_background(const std::string& text, Arguments& a) {
  const int64_t label = parse_whole("--background", text);
  check_range("--background", double(label), kLabels);
  a.run.input.labels.background = int32_t(label);
}

void set_smallest_island(const std::string& text, Arguments& a) {
  const int64_t voxels = parse_whole("--smallest-island", text);
  check_range("--smallest-island", double(voxels), kIslands);
  a.run.input.labels.smallest_island_vox = voxels;
}

void set_smoothing(const std::string& text, Arguments& a) {
  const double voxels = parse_number("--smoothing", text);
  check_range("--smoothing", voxels, kSmoothing);
  a.run.input.labels.smoothing_vox = voxels;
}

void set_periodic(const std::string& text, Arguments& a) {
  const std::string names = "xyz";
  std::array<bool, 3> axes{false, false, false};
  std::istringstream listed(text);
  for (std::string axis; std::getline(listed, axis, ',');) {
    const size_t at = axis.size() == 1 ? names.find(axis) : std::string::npos;
    if (at == std::string::npos)
      throw Error(ErrorCode::usage, "command line", "--periodic is '" + text + "'; give axes, x, y or z, as in x,y");
    axes[at] = true;
  }
  a.run.input.labels.is_periodic = axes;
}

void set_grids(const std::string& text, Arguments& a) { a.run.input.grids = parse_names("--grids", text, "all, or "); }

void set_threads(const std::string& text, Arguments& a) {
  const int64_t count = parse_whole("--threads", text);
  check_range("--threads", double(count), {1, 4096});
  a.threads = int(count);
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

void set_stop_after(const std::string& text, Arguments& a) {
  a.run.stop_after = parse_choice<StopAfter>(
      "--stop-after", text,
      {{"shell", StopAfter::shell}, {"voronoi", StopAfter::voronoi}, {"level-set", StopAfter::level_set}});
}

void set_level_set_band(const std::string& text, Arguments& a) {
  a.run.level_set.band_vox = parse_number("--level-set-band", text);
  check_range("--level-set-band", a.run.level_set.band_vox, kLevelSetBand);
}

void set_progress(const std::string& text, Arguments& a) {
  a.progress = parse_choice<ProgressMode>("--progress", text,
                                          {{"auto", ProgressMode::automatic},
                                           {"always", ProgressMode::always},
                                           {"never", ProgressMode::never},
                                           {"json", ProgressMode::json}});
}

void set_requirements(const std::string& text, Arguments& a) {
  const bool allow_intersections = a.run.gates.allow_intersections;
  a.run.gates = parse_gates(text);
  a.run.gates.allow_intersections = allow_intersections;
}

Set text_of(std::string RunRequest::*member) {
  return [member](const std::string& text, Arguments& a) { a.run.*member = text; };
}

Set flag_of(bool Arguments::*member, bool value = true) {
  return [member, value](const std::string&, Arguments& a) { a.*member = value; };
}

Set verbosity(int value) {
  return [value](const std::string&, Arguments& a) { a.verbosity = value; };
}

void nothing(const std::string&, Arguments&) {}

CommandOption of_run(const OptionRow& row) {
  return {{row.group, row.name, row.value_name, row.text, row.fallback, row.is_real(), false, row.range, row.repeats()},
          [&row](const std::string& text, Arguments& a) {
            set_from_text(row, std::string("--") + row.name, text, a.run.options);
          },
          "",
          row.instead_of};
}

constexpr char kFiles[] = "Files";

std::vector<CommandOption> input_options() {
  const char* group = kFiles;
  return {
      {{group, "iso", "V", "isovalue of a volume; required for a fog volume",
        "0 in a level set and in unsigned distances", true},
       set_iso},
      {{group, "background", "LABEL", "of a volume of labels: the label of what is no region",
        "that around the labels, mostly 0", false, false, kLabels},
       set_background},
      {{group, "smallest-island", "N",
        "of a volume of labels: islands of fewer voxels get the label around them, but the largest one of each "
        "region; 0: none do",
        "8", false, false, kIslands},
       set_smallest_island},
      {{group, "smoothing", "VOX",
        "of a volume of labels: how far, in voxels, walls may leave the faces of their voxels to be smooth; at 0 they "
        "are these faces, flat, with creases where they turn",
        "0.5", true, false, kSmoothing},
       set_smoothing},
      {{group, "periodic", "AXES",
        "of a volume of labels: axes of its array, as x,y,z, along which it goes on with its first layer: walls of one "
        "period, from the centres of that layer to those of its repetition, with the same triangles on opposite sides",
        "none"},
       set_periodic},
      {{group, "grids", "all|LIST",
        "give vertices the values of these grids of INPUT's .vdb file, as v,Cd,temperature, or of others, as "
        "FILE.vdb:NAME; all: all numbers and vectors beside the grid that is meshed",
        "none"},
       set_grids},
      {{group, "union", "", "of several level sets: one surface around all of them, not a region of each"},
       [](const std::string&, Arguments& a) { a.run.input.unite = true; }},
      {{group, "reference", "FILE[:GRID]",
        "of several level sets: the mesh or level set that they were cut from; faces of the result that lie on it are "
        "of "
        "the material exterior, others of the material inner",
        "none"},
       [](const std::string& text, Arguments& a) { a.run.input.reference = text; }},
      {{group, "input-format", "F", "format of INPUT: " + listed_formats(reads_anything), "by its name"},
       [](const std::string& text, Arguments& a) { a.run.input.format = text; }},
  };
}

std::vector<CommandOption> output_options() {
  const char* group = kFiles;
  return {
      {{group, "output-format", "F", "format of OUTPUT: " + listed_formats(writes_mesh, ", ") + " or vdb",
        "by its name"},
       [](const std::string& text, Arguments& a) { a.run.output.format = text; }},
      {{group, "output", "OUTPUT", "the same as OUTPUT behind INPUT", "", false, true}, nothing, "o"},
      {{group, "save-shell", "F.vdb", "also write the shell, to resume from"}, text_of(&RunRequest::save_shell)},
      {{group, "save-voronoi", "F.vdb", "also write the Voronoi volume, to resume from"},
       text_of(&RunRequest::save_voronoi)},
      {{group, "save-level-set", "F.vdb",
        "also write signed distances around the closed surface, on the grid of --resolution or --voxel-size"},
       [](const std::string& text, Arguments& a) { a.run.level_set.path = text; }},
      {{group, "level-set-band", "VOX", "how far, in voxels, a level set reaches on both sides", "3", true, false,
        kLevelSetBand},
       set_level_set_band},
      {{group, "level-set-of", "input|result",
        "what a level set has the distances to: the surface of INPUT, with its holes closed, or the resulting mesh",
        "input"},
       [](const std::string& text, Arguments& a) {
         a.run.level_set.of = parse_choice<LevelSetOf>("--level-set-of", text,
                                                       {{"input", LevelSetOf::input}, {"result", LevelSetOf::result}});
       }},
      {{group, "level-set-half", "", "write level sets with values of 16 bits, of half the size"},
       [](const std::string&, Arguments& a) { a.run.level_set.as_half = true; }},
      {{group, "split-regions", "DIR",
        "also write each region of the result as a closed mesh of its own, DIR/NAME or DIR/LABEL, in the format of "
        "OUTPUT"},
       text_of(&RunRequest::split_regions)},
      {{group, "recenter", "auto|X,Y,Z",
        "write meshes with this place at the origin, auto: round numbers near the middle of the result; for formats "
        "whose numbers are too coarse far from the origin, as STL"},
       [](const std::string& text, Arguments& a) { a.run.output.recenter = parse_recenter(text); }},
      {{group, "stop-after", "shell|voronoi|level-set", "stop after this stage; OUTPUT is its .vdb file"},
       set_stop_after},
      {{group, "stats", "F.json", "write all statistics as JSON; - writes to standard output"},
       text_of(&RunRequest::statistics)},
      {{group, "report", "F.html",
        "also write a page that shows the result beside the input, with all that was measured; by the Python module "
        "alone: pip install isoshell[report]"},
       text_of(&RunRequest::report)},
      {{group, "force", "", "overwrite existing files"},
       [](const std::string&, Arguments& a) { a.run.overwrite = true; }},
  };
}

std::vector<CommandOption> sequence_options() {
  const char* group = "Sequences";
  std::vector<CommandOption> options = {
      {{group, "frames", "A-B[xSTEP]",
        "mesh the frames from A to B, every STEP-th, each beginning with the one before, so that vertices keep their "
        "numbers; INPUT, OUTPUT and --stats have #### or %04d where the number is"},
       [](const std::string& text, Arguments& a) { a.frames = parse_frames(text); }},
      {{group, "velocity", "GRID",
        "grid of velocities in the .vdb file of a frame, in world units a frame: where its surface goes until the "
        "next"},
       [](const std::string& text, Arguments& a) { a.velocity = text; }},
      {{group, "no-coherence", "", "begin every frame anew"}, flag_of(&Arguments::is_coherent, false)},
      {{group, "keep-going", "", "go on after a frame that cannot be read or meshed, or misses a gate"},
       flag_of(&Arguments::keep_going)},
      {{group, "resume", "",
        "leave out the frames whose OUTPUT is there, whole and as this run would make it, and go on after them; in "
        "PLY"},
       flag_of(&Arguments::resume)},
  };
  for (CommandOption& option : options) option.entry.of_command = true;
  return options;
}

std::vector<CommandOption> process_options() {
  const char* group = "Run";
  return {
      {{group, "require", "LIST",
        "exit with status 6 unless the result meets every requirement of this comma-separated list: " +
            listed_gates(true)},
       set_requirements},
      {{group, "allow-intersections", "", "exit with status 0, not 6, where the result intersects itself"},
       [](const std::string&, Arguments& a) { a.run.gates.allow_intersections = true; }},
      {{group, "device", "auto|cpu|cuda[:N]", "device to run on", "auto"}, set_device},
      {{group, "threads", "N", "number of CPU threads", "all"}, set_threads},
      {{group, "max-memory", "SIZE",
        "refuse a run that would need more memory than this (of the device, for a run there), as 512M or 8G",
        "80 % of the free memory"},
       [](const std::string& text, Arguments& a) { a.max_memory_bytes = parse_size_bytes(text); }},
      {{group, "dry-run", "", "print the grid and the memory estimate, with --stats - also as JSON, and exit", "",
        false, true},
       flag_of(&Arguments::dry_run)},
      {{group, "progress", "auto|always|never|json", "report progress on standard error", "auto"}, set_progress},
      {{group, "verbose", "", "print more messages"}, verbosity(2), "v"},
      {{group, "quiet", "", "print errors only"}, verbosity(0), "q"},
      {{group, "help", "", "print this help and exit", "", false, true}, nothing, "h"},
      {{group, "version", "", "print the version and exit", "", false, true}, nothing, "V"},
  };
}

}  // namespace

std::vector<CommandOption> command_options() {
  std::vector<CommandOption> all;
  for (const OptionRow& row : option_rows()) all.push_back(of_run(row));
  for (const std::vector<CommandOption>& part :
       {input_options(), output_options(), sequence_options(), process_options()})
    all.insert(all.end(), part.begin(), part.end());
  return all;
}

}  // namespace isoshell::tool
