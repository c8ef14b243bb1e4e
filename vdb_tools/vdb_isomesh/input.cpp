// Tells meshes, point clouds, volumes and stage files apart.
#include "vdb_isomesh/input.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "isoshell/error.h"
#include "isoshell/io/vdb_file.h"

namespace isoshell::tool {
namespace {

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::unreadable_input, "read", message); }

void check_exists(const std::string& path) {
  std::error_code code;
  const std::filesystem::file_status status = std::filesystem::status(path, code);
  if (!std::filesystem::exists(status)) refuse(path + ": no such file");
  if (std::filesystem::is_directory(status)) refuse(path + ": is a folder, not a file");
  if (access(path.c_str(), R_OK) != 0) refuse(path + ": " + std::strerror(errno));  // a pipe opens only once
}

}  // namespace

const char* kind_name(InputKind kind) {
  switch (kind) {
    case InputKind::mesh:
    case InputKind::ply:
      return "mesh";
    case InputKind::points:
      return "points";
    case InputKind::volume:
      return "volume";
    case InputKind::stage:
      return "stage";
  }
  return "";
}

InputKind classify_input(const std::string& path, const std::string& format) {
  if (path != "-") check_exists(path);
  if (format == "obj" || format == "stl" || format == "off") return InputKind::mesh;
  if (format == "ply") return InputKind::ply;
  if (format == "xyz" || format == "pcd") return InputKind::points;
  if (format == "nvdb") return InputKind::volume;
  if (format == "vdb") return path != "-" && is_stage_file(path) ? InputKind::stage : InputKind::volume;
  refuse(path + ": the format '" + format +
         "' is not one of obj, ply, stl, off, xyz, pcd, vdb, nvdb; say which by --input-format");
}

MeshFormat mesh_format(const std::string& format) {
  if (format == "ply") return MeshFormat::ply;
  if (format == "obj") return MeshFormat::obj;
  if (format == "stl") return MeshFormat::stl;
  if (format == "off") return MeshFormat::off;
  return MeshFormat::from_name;
}

}  // namespace isoshell::tool
