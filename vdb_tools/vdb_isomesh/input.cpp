// Tells meshes, point clouds, volumes and stage files apart.
#include "vdb_isomesh/input.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

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
  if (!std::ifstream(path, std::ios::binary)) refuse(path + ": " + std::strerror(errno));
}

/// Whether the header of a PLY file declares no faces and no strips, so that it holds points only.
bool is_ply_without_faces(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string line;
  if (!std::getline(file, line) || line.compare(0, 3, "ply") != 0) return false;
  bool vertices = false;
  for (int lines = 0; lines < 1000 && std::getline(file, line); ++lines) {
    std::istringstream words(line);
    std::string word, element;
    int64_t count = 0;
    words >> word >> element >> count;
    if (word == "end_header") return vertices;
    if (word != "element") continue;
    if (element == "vertex") vertices = count > 0;
    if ((element == "face" || element == "tristrips") && count > 0) return false;
  }
  return false;
}

}  // namespace

const char* kind_name(InputKind kind) {
  switch (kind) {
    case InputKind::mesh:
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
  if (format == "ply") return path != "-" && is_ply_without_faces(path) ? InputKind::points : InputKind::mesh;
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
