#include "run/outputs.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <vector>

#include "core/file_format.h"
#include "isoshell/error.h"
#include "isoshell/io/file_format.h"
#include "isoshell/io/sizing_vdb.h"
#include "isoshell/io/vdb_file.h"
#include "isoshell/options/option_text.h"

namespace isoshell {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::unwritable_output, "write", message); }
[[noreturn]] void refuse_use(const std::string& message) { throw Error(ErrorCode::usage, "write", message); }

[[noreturn]] void refuse_vdb_to_pipe() { refuse_use("a .vdb file cannot be written to standard output; name a file"); }

void check_output(const std::string& path, bool overwrite) {
  std::error_code code;
  const fs::file_status status = fs::status(path, code);
  if (fs::is_directory(status)) refuse(path + ": is a folder; name a file");
  if (fs::exists(status) && !fs::is_regular_file(status))
    refuse(path + ": is not a regular file; name another, or - for standard output");
  if (fs::exists(status) && !overwrite) refuse(path + ": exists already; --force replaces it");
  const fs::path folder = fs::path(path).has_parent_path() ? fs::path(path).parent_path() : fs::path(".");
  if (!fs::is_directory(folder, code)) refuse(path + ": there is no folder " + folder.string());
  if (access(folder.c_str(), W_OK) != 0)
    refuse(path + ": cannot write in " + folder.string() + ": " + std::strerror(errno));
}

}  // namespace

std::string preview_path(const std::string& path) {
  const bool named = fs::path(path).extension() == ".vdb";
  return path.substr(0, path.size() - (named ? 4 : 0)) + ".preview.vdb";
}

OutputRequest named_output(const std::string& path, const std::string& format, StopAfter stop_after) {
  OutputRequest output{path, format_name(format)};
  if (path == "-" && output.format.empty())
    refuse_use("OUTPUT is standard output; say what to write by --output-format");
  if (output.format.empty()) output.format = format_of_path(path);
  if (path.empty()) return output;
  if (stop_after == StopAfter::mesh) {
    const FileFormat* const written = find_format(output.format);
    if (!written || !written->writes_mesh)
      refuse_use("the format of OUTPUT is '" + output.format + "'; it must be one of " +
                 listed_formats(writes_mesh, ", "));
  } else {
    if (output.format != "vdb") refuse_use("with --stop-after, OUTPUT is a .vdb file; it is '" + path + "'");
    if (path == "-") refuse_vdb_to_pipe();
  }
  return output;
}

Features possible_features(const RemeshOptions& options, const RunRequest& r) {
  if (r.save_voronoi.empty() && r.stop_after != StopAfter::voronoi) return options.features;
  if (options.boundary == Boundary::keep)
    refuse_use(
        "a Voronoi stage file does not hold the seeds of borders; give --boundary close, or keep a shell instead");
  if (options.features.creases != Features::Creases::threshold && !options.features.has_lines())
    return {Features::Creases::off, 0};
  refuse_use(
      "a Voronoi stage file does not hold the seeds of creases and lines; give --features off, or keep a shell "
      "instead");
}

void check_request(const RunRequest& r) {
  check_method(r.options);
  if (r.gates.any() && r.stop_after != StopAfter::mesh) refuse_use("--require needs a mesh; leave out --stop-after");
  if (!r.report.empty() && r.stop_after != StopAfter::mesh) refuse_use("--report needs a mesh; leave out --stop-after");
  if (r.report == "-") refuse_use("--report cannot be written to standard output; name a file");
  if (r.save_shell == "-" || r.save_voronoi == "-") refuse_vdb_to_pipe();
  possible_features(r.options.values, r);
  if (r.output.path == "-" && r.statistics == "-") refuse_use("OUTPUT and --stats cannot both be standard output");
  const OutputRequest output = named_output(r.output.path, r.output.format, r.stop_after);  // may refuse it
  if (r.options.values.color_features && r.stop_after == StopAfter::mesh && !output.path.empty() &&
      !find_format(output.format)->holds_edges)
    refuse_use("--color-features needs a PLY file; OUTPUT is '" + output.path + "'");
  if (!r.options.sizing.empty() && !can_write_vdb()) read_sizing(r.options.sizing);  // says that there is no OpenVDB
}

void check_outputs(const RunRequest& r) {
  std::vector<std::string> files = {r.output.path, r.statistics, r.report, r.save_shell, r.save_voronoi};
  if (!r.save_voronoi.empty()) files.push_back(preview_path(r.save_voronoi));
  if (r.stop_after == StopAfter::voronoi && !r.output.path.empty()) files.push_back(preview_path(r.output.path));
  if (!can_write_vdb() && (r.stop_after != StopAfter::mesh || !r.save_shell.empty() || !r.save_voronoi.empty()))
    refuse(
        "this build writes no .vdb files: leave out --stop-after, --save-shell and --save-voronoi, or build with "
        "-DISOSHELL_VDB=ON");
  for (size_t i = 0; i < files.size(); ++i) {
    if (files[i].empty() || files[i] == "-") continue;
    check_output(files[i], r.overwrite);
    for (size_t j = 0; j < i; ++j)
      if (fs::path(files[i]).lexically_normal() == fs::path(files[j]).lexically_normal())
        refuse_use(files[i] + " is named twice; every result needs its own file");
  }
}

}  // namespace isoshell
