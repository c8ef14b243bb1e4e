#include "run/outputs.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>
#include <vector>

#include "core/file_format.h"
#include "isoshell/error.h"
#include "isoshell/io/file_format.h"
#include "isoshell/io/mesh_file.h"
#include "isoshell/io/python_formats.h"
#include "isoshell/io/sizing_vdb.h"
#include "isoshell/io/vdb_file.h"
#include "isoshell/options/option_text.h"
#include "isoshell/region_census.h"
#include "run/stage_files.h"

namespace isoshell {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::unwritable_output, "write", message); }
[[noreturn]] void refuse_use(const std::string& message) { throw Error(ErrorCode::usage, "write", message); }

fs::path folder_of(const fs::path& path) { return path.has_parent_path() ? path.parent_path() : fs::path("."); }

void check_folder(const std::string& path, const fs::path& folder) {
  std::error_code code;
  if (!fs::is_directory(folder, code)) refuse(path + ": there is no folder " + folder.string());
  if (access(folder.c_str(), W_OK) != 0)
    refuse(path + ": cannot write in " + folder.string() + ": " + std::strerror(errno));
}

/// A folder that is there, or can be made.
void check_folder_of_regions(const std::string& path) {
  std::error_code code;
  if (fs::is_directory(path, code)) return check_folder(path, path);
  if (fs::exists(fs::symlink_status(path, code))) refuse(path + ": is no folder; --split-regions needs one");
  check_folder(path, folder_of(fs::path(path).has_filename() ? fs::path(path) : fs::path(path).parent_path()));
}

/// The name of a region as one of a file: without what separates folders or means something to a shell.
std::string safe_name(std::string name) {
  constexpr size_t kLongest = 120;  // bytes; file systems take 255
  for (char& c : name) {
    const auto byte = static_cast<unsigned char>(c);
    const bool is_plain = byte >= 0x80 || std::isalnum(byte) != 0 || c == '-' || c == '.' || c == '_';
    if (!is_plain) c = '_';
  }
  if (name.size() > kLongest) {
    size_t end = kLongest;
    while (end > 0 && (static_cast<unsigned char>(name[end]) & 0xC0) == 0x80) --end;  // no part of a letter stays
    name.resize(end);
  }
  if (!name.empty() && (name[0] == '.' || name[0] == '-')) name[0] = '_';
  return name;
}

std::string in_lower_case(std::string text) {
  for (char& c : text) c = c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c;
  return text;
}

void check_one_to_pipe(const std::vector<NamedFile>& outputs) {
  std::string to_pipe;
  for (const NamedFile& file : outputs) {
    if (file.path != "-") continue;
    if (!to_pipe.empty()) refuse_use(to_pipe + " and " + file.what + " cannot both be standard output");
    to_pipe = file.what;
  }
}

/// Appends their labels to names that are used twice, until none is: a name has its label once, and those that have one
/// differ.
void part_equal_names(std::map<int32_t, std::string>& name_of_label) {
  std::set<int32_t> numbered;
  for (bool has_changed = true; has_changed;) {
    has_changed = false;
    std::map<std::string, int> uses;
    for (const auto& [label, name] : name_of_label) ++uses[in_lower_case(name)];
    for (auto& [label, name] : name_of_label)
      if (uses[in_lower_case(name)] > 1 && numbered.insert(label).second) {
        name += "_" + std::to_string(label);
        has_changed = true;
      }
  }
}

}  // namespace

std::string preview_path(const std::string& path) {
  if (path.empty() || path == "-") return "";
  const bool named = fs::path(path).extension() == ".vdb";
  return path.substr(0, path.size() - (named ? 4 : 0)) + ".preview.vdb";
}

OutputRequest named_output(const std::string& path, const std::string& format, StopAfter stop_after) {
  OutputRequest output{path, format_name(format)};
  if (path == "-" && output.format.empty()) {
    if (stop_after == StopAfter::mesh) refuse_use("OUTPUT is standard output; say what to write by --output-format");
    output.format = "vdb";
  }
  if (output.format.empty()) output.format = format_of_path(path);
  if (path.empty()) return output;
  if (stop_after == StopAfter::mesh) {
    const FileFormat* const written = find_format(output.format);
    if (!written || !written->writes_mesh)
      refuse_use("the format of OUTPUT is '" + output.format + "'; it must be one of " +
                 listed_formats(writes_mesh, ", ") + (format.empty() ? python_remedy(path, true) : ""));
  } else {
    if (output.format != "vdb") refuse_use("with --stop-after, OUTPUT is a .vdb file; it is '" + path + "'");
  }
  return output;
}

Features possible_features(const RunOptions& options, const RunRequest& r) {
  if (r.save_voronoi.empty() && r.stop_after != StopAfter::voronoi) return options.features;
  if (options.boundary == Boundary::keep)
    refuse_use(
        "a Voronoi stage file does not hold the seeds of borders; give --boundary close, or keep a shell instead");
  if (options.features.creases != Features::Creases::threshold && !options.has_lines())
    return {Features::Creases::off, 0};
  refuse_use(
      "a Voronoi stage file does not hold the seeds of creases and lines; give --features off, or keep a shell "
      "instead");
}

Recenter parse_recenter(const std::string& text) {
  if (text == "auto") return {true};
  std::vector<double> numbers;
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');) numbers.push_back(parse_real("--recenter", part));
  const bool is_place = numbers.size() == 3 && std::all_of(numbers.begin(), numbers.end(),
                                                           [](double number) { return std::isfinite(number); });
  if (!is_place) refuse_use("--recenter is '" + text + "'; it must be auto or three finite numbers, as 500000,0,-20");
  return {true, WorldPoint{numbers[0], numbers[1], numbers[2]}};
}

std::vector<NamedFile> outputs_of(const RunRequest& r) {
  const char* const replaced = r.report.empty() ? kInput : "";  // a report reads it again
  std::vector<NamedFile> files = {
      {"OUTPUT", r.output.path, replaced}, {"--stats", r.statistics},          {"--report", r.report},
      {"--save-shell", r.save_shell},      {"--save-voronoi", r.save_voronoi}, {"--save-level-set", r.level_set.path}};
  files.push_back({"the preview", preview_path(r.save_voronoi)});
  if (r.stop_after == StopAfter::voronoi) files.push_back({"the preview", preview_path(r.output.path)});
  return files;
}

std::string file_of_sizing(const std::string& sizing) {
  if (!is_sizing_file(sizing)) return "";
  const GridName named = grid_name_of(sizing);
  return named.file.empty() ? sizing : named.file;
}

std::vector<NamedFile> inputs_of(const RunRequest& r) {
  std::vector<NamedFile> files = {{kInput, r.input.path},
                                  {"--sizing", file_of_sizing(r.options.sizing)},
                                  {"--features", r.options.values.line_file}};
  for (const std::string& name : r.input.grids) files.push_back({"--grids", grid_name_of(name).file});
  for (const std::string& name : r.input.also) files.push_back({kInput, named_input(name).path});
  if (!r.input.reference.empty()) files.push_back({"--reference", named_input(r.input.reference).path});
  return files;
}

void check_whole_request(const RunRequest& r) {
  check_request(r);
  check_several(r.input);
  check_level_set_is_asked(r);
}

void check_request(const RunRequest& r) {
  check_together(r.options);
  if (r.output.recenter.is_asked && r.stop_after != StopAfter::mesh)
    refuse_use("--recenter is for files of meshes; leave out --stop-after");
  if (r.gates.count && (r.options.values.edge_length_world || r.options.lengths_decide()))
    refuse_use("--require count compares with the vertices that were asked for; give --vertices, or leave it out");
  if (r.gates.any() && r.stop_after != StopAfter::mesh) refuse_use("--require needs a mesh; leave out --stop-after");
  if (!r.report.empty() && r.stop_after != StopAfter::mesh) refuse_use("--report needs a mesh; leave out --stop-after");
  if (!r.split_regions.empty() && r.stop_after != StopAfter::mesh)
    refuse_use("--split-regions needs a mesh; leave out --stop-after");
  if (r.input.samples_grids() && r.stop_after != StopAfter::mesh)
    refuse_use("--grids needs a mesh; leave out --stop-after");
  if (r.report == "-") refuse_use("--report cannot be written to standard output; name a file");
  possible_features(r.options.values, r);
  if (!r.save_voronoi.empty() && (r.stop_after == StopAfter::shell || r.stop_after == StopAfter::level_set))
    refuse_use("--save-voronoi needs seeds, which come after --stop-after; leave one of them out");
  check_level_set(r);
  check_one_to_pipe(outputs_of(r));
  const OutputRequest output = named_output(r.output.path, r.output.format, r.stop_after);  // may refuse it
  if (r.options.values.color_features && r.stop_after == StopAfter::mesh && !output.path.empty() &&
      !find_format(output.format)->holds_edges)
    refuse_use("--color-features needs a PLY file; OUTPUT is '" + output.path + "'");
  if (is_sizing_file(r.options.sizing) && !can_write_vdb())
    read_sizing(r.options.sizing);  // says that there is no OpenVDB
}

void check_outputs(const RunRequest& r) {
  const bool is_stage_file = r.stop_after != StopAfter::mesh && !r.output.path.empty();
  if (!can_write_vdb() &&
      (is_stage_file || !r.save_shell.empty() || !r.save_voronoi.empty() || !r.level_set.path.empty()))
    refuse(
        "this build writes no .vdb files: leave out --stop-after, --save-shell, --save-voronoi and --save-level-set, "
        "or "
        "build with -DISOSHELL_VDB=ON");
  const bool is_later_frame = !r.written_before.empty();  // then the first one has removed what was left
  check_output_files(outputs_of(r), inputs_of(r), r.overwrite, is_later_frame);
  if (!r.split_regions.empty()) check_folder_of_regions(r.split_regions);
}

std::vector<RegionFile> region_files(const FaceRegions& regions, const std::string& folder, const std::string& format) {
  std::map<int32_t, std::string> name_of_label;
  for (const std::array<int32_t, 2>& pair : regions.labels)
    for (const int32_t label : pair)
      if (label != regions.background) name_of_label.try_emplace(label);
  for (const auto& [label, name] : regions.names)
    if (const auto found = name_of_label.find(label); found != name_of_label.end()) found->second = safe_name(name);
  for (auto& [label, name] : name_of_label)
    if (name.empty()) name = std::to_string(label);
  part_equal_names(name_of_label);
  std::vector<RegionFile> files;
  for (const auto& [label, name] : name_of_label)
    files.push_back({label, (fs::path(folder) / (name + "." + format)).string()});
  return files;
}

std::vector<RegionFile> checked_region_files(const RunRequest& r, const FaceRegions& regions) {
  if (r.split_regions.empty()) return {};
  if (regions.empty())
    refuse_use("--split-regions is for volumes of labels and meshes of regions, and INPUT has none; leave it out");
  const std::string format = named_output(r.output.path, r.output.format, r.stop_after).format;
  std::vector<RegionFile> files = region_files(regions, r.split_regions, format.empty() ? "ply" : format);
  if (!fs::exists(r.split_regions)) return files;
  std::vector<NamedFile> all = outputs_of(r);
  for (const RegionFile& file : files) all.push_back({"--split-regions", file.path});
  check_output_files(all, inputs_of(r), r.overwrite);
  return files;
}

std::vector<RegionFile> files_of_kept(const std::vector<RegionFile>& files, const TriangleMesh& mesh,
                                      const std::function<void(const std::string&)>& warn) {
  std::set<int32_t> labels;
  for (const auto& [behind, front] : mesh.regions.labels) labels.insert({behind, front});
  std::vector<RegionFile> kept;
  for (const RegionFile& file : files)
    if (labels.count(file.label) > 0)
      kept.push_back(file);
    else
      warn("region " + std::to_string(file.label) + " has no faces in the result, and gets no file of its own");
  return kept;
}

void write_output(const TriangleMesh& mesh, const RunRequest& request, bool curve_edges, const WrittenFile& output) {
  MeshWriteOptions options{output.format, request.overwrite, curve_edges};
  options.held = output.held;
  options.may_lose_triangles = true;  // a gate says it
  options.made_of = request.made_of;
  write_mesh(output.path, mesh, options);
}

void write_region(const RegionFile& file, const TriangleMesh& mesh, bool overwrite, RunRecord& record) {
  std::error_code code;
  const fs::path folder = folder_of(file.path);
  fs::create_directory(folder, code);
  if (code) refuse(folder.string() + ": cannot be made: " + code.message());
  const TriangleMesh region = region_of(mesh, file.label);
  MeshWriteOptions options{format_of_path(file.path), overwrite};
  options.held = positions_in_file(region, options.format, record.output.recenter.offset()).held;
  options.may_lose_triangles = true;
  record.files.push_back({file.path, options.format, *options.held});
  write_mesh(file.path, region, options);
}

}  // namespace isoshell
