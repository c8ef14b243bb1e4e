// The table of formats. A format is a row here, and a file of its own with the functions that the row names.
#include "io/file_formats.h"

#include <algorithm>

namespace isoshell {

TriangleSoup read_ply(const MeshSource&);
PointCloud read_ply_points(const MeshSource&);
void write_ply(OutputFile&, const TriangleMesh&, const Placement&, const MeshWriteOptions&);
Placement place_in_ply(const TriangleMesh&, const WorldPoint&);
std::string what_ply_lacks(const Attribute&);
TriangleSoup read_obj(const MeshSource&);
void write_obj(OutputFile&, const TriangleMesh&, const Placement&, const MeshWriteOptions&);
std::string what_obj_lacks(const Attribute&);
TriangleSoup read_stl(const MeshSource&);
void write_stl(OutputFile&, const TriangleMesh&, const Placement&, const MeshWriteOptions&);
TriangleSoup read_off(const MeshSource&);
void write_off(OutputFile&, const TriangleMesh&, const Placement&, const MeshWriteOptions&);
TriangleSoup read_gltf(const MeshSource&);
void write_glb(OutputFile&, const TriangleMesh&, const Placement&, const MeshWriteOptions&);
void write_gltf(OutputFile&, const TriangleMesh&, const Placement&, const MeshWriteOptions&);
Placement place_in_gltf(const TriangleMesh&, const WorldPoint&);
std::string what_gltf_lacks(const Attribute&);
PointCloud read_xyz(const MeshSource&);
PointCloud read_pcd(const MeshSource&);

namespace {

using Write = void(OutputFile&, const TriangleMesh&, const Placement&, const MeshWriteOptions&);

FormatRow of_meshes(const char* name, TriangleSoup (*read)(const MeshSource&), Write* write,
                    Placement (*place)(const TriangleMesh&, const WorldPoint&),
                    std::string (*lacks)(const Attribute&)) {
  FormatRow row{{name}, read, nullptr, write, place, lacks};
  row.format.reads_mesh = row.format.writes_mesh = true;
  return row;
}

FormatRow of_ply() {
  FormatRow row = of_meshes("ply", read_ply, write_ply, place_in_ply, what_ply_lacks);
  row.read_points = read_ply_points;
  row.format.reads_points = row.format.holds_edges = row.format.holds_textures = row.format.holds_regions = true;
  return row;
}

FormatRow of_obj() {
  FormatRow row = of_meshes("obj", read_obj, write_obj, place_in_doubles, what_obj_lacks);
  row.format.holds_regions = true;
  return row;
}

FormatRow of_stl() {
  FormatRow row = of_meshes("stl", read_stl, write_stl, place_in_floats,
                            [](const Attribute&) -> std::string { return "STL files are written without attributes"; });
  row.format.joins_vertices = true;
  return row;
}

FormatRow of_gltf(const char* name, Write* write) {
  FormatRow row = of_meshes(name, read_gltf, write, place_in_gltf, what_gltf_lacks);
  row.format.holds_gltf_materials = row.format.holds_regions = true;
  return row;
}

FormatRow of_points(const char* name, PointCloud (*read)(const MeshSource&)) {
  FormatRow row{{name}, nullptr, read};
  row.format.reads_points = true;
  return row;
}

FormatRow of_volumes(const char* name) {
  FormatRow row{{name}};
  row.format.reads_volume = true;
  row.lacks = [](const Attribute&) -> std::string { return "stage files hold no attributes"; };
  return row;
}

const std::vector<FormatRow>& rows() {
  static const std::vector<FormatRow> all = {
      of_ply(),
      of_obj(),
      of_stl(),
      of_meshes("off", read_off, write_off, place_in_doubles,
                [](const Attribute&) -> std::string { return "OFF files are written without attributes"; }),
      of_gltf("glb", write_glb),
      of_gltf("gltf", write_gltf),
      of_points("xyz", read_xyz),
      of_points("pcd", read_pcd),
      of_volumes("vdb"),
      of_volumes("nvdb"),
  };
  return all;
}

template <class Text>
std::string joined(bool (*is_one)(const FileFormat&), Text text_before) {
  std::vector<std::string> names;
  for (const FormatRow& row : rows())
    if (is_one(row.format)) names.push_back(row.format.name);
  std::string text;
  for (size_t i = 0; i < names.size(); ++i) text += text_before(i, names.size()) + names[i];
  return text;
}

}  // namespace

const FormatRow* find_row(const std::string& name) {
  const auto found =
      std::find_if(rows().begin(), rows().end(), [&](const FormatRow& row) { return row.format.name == name; });
  return found == rows().end() ? nullptr : &*found;
}

const std::vector<FileFormat>& file_formats() {
  static const std::vector<FileFormat> formats = [] {
    std::vector<FileFormat> all;
    for (const FormatRow& row : rows()) all.push_back(row.format);
    return all;
  }();
  return formats;
}

const FileFormat* find_format(const std::string& name) {
  const FormatRow* row = find_row(name);
  return row ? &row->format : nullptr;
}

std::string why_not_held(const std::string& format, const Attribute& attribute) {
  const FormatRow* row = find_row(format);
  return row && row->lacks ? row->lacks(attribute) : "";
}

std::string listed_formats(bool (*is_one)(const FileFormat&), const std::string& last) {
  return joined(is_one, [&](size_t i, size_t count) { return i == 0 ? "" : i + 1 < count ? ", " : last; });
}

std::string listed_endings(bool (*is_one)(const FileFormat&)) {
  return joined(is_one, [](size_t i, size_t) { return i == 0 ? "." : " ."; });
}

bool reads_mesh(const FileFormat& format) { return format.reads_mesh; }
bool reads_points(const FileFormat& format) { return format.reads_points; }
bool reads_volume(const FileFormat& format) { return format.reads_volume; }
bool reads_anything(const FileFormat& format) {
  return reads_mesh(format) || reads_points(format) || reads_volume(format);
}
bool writes_mesh(const FileFormat& format) { return format.writes_mesh; }

}  // namespace isoshell
