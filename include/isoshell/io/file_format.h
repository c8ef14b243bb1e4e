// The formats of files: what readers, writers, the commands and the module know of each.
#pragma once

#include <string>
#include <vector>

#include "isoshell/attribute.h"

namespace isoshell {

struct FileFormat {
  std::string name;  ///< lower case, and how names of such files end
  bool reads_mesh = false, reads_points = false, reads_volume = false, writes_mesh = false;
  bool holds_edges = false;           ///< of curves, beside triangles
  bool holds_textures = false;        ///< names of images, AttributeFiles::textures
  bool holds_gltf_materials = false;  ///< AttributeFiles::gltf_materials
  bool holds_regions = false;         ///< TriangleMesh::regions
  bool joins_vertices = false;        ///< of one position: it has no other numbers of them
};

/// All of them. Meshes come first, and the default for meshes first of these.
const std::vector<FileFormat>& file_formats();

/// Null for a name that is none of them.
const FileFormat* find_format(const std::string& name);

/// Why files of the format do not hold the attribute; empty where they do, or the name is that of no format.
std::string why_not_held(const std::string& format, const Attribute& attribute);

/// "ply, obj or off", of the formats for which `is_one` is true. With another word between the last two.
std::string listed_formats(bool (*is_one)(const FileFormat&), const std::string& last = " or ");
/// ".ply .obj .off"
std::string listed_endings(bool (*is_one)(const FileFormat&));

bool reads_mesh(const FileFormat& format);
bool reads_points(const FileFormat& format);
bool reads_volume(const FileFormat& format);
bool reads_anything(const FileFormat& format);
bool writes_mesh(const FileFormat& format);

}  // namespace isoshell
