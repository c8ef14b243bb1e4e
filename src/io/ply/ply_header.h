// The header of a PLY file.
#pragma once

#include <string>
#include <vector>

#include "io/bytes/mesh_source.h"
#include "isoshell/attribute.h"

namespace isoshell {

enum class PlyEncoding { ascii, little_endian, big_endian };
using PlyType = NumberType;

int64_t size_of(PlyType type);
const char* name_of(PlyType type);
inline bool is_real(PlyType type) { return type == PlyType::f32 || type == PlyType::f64; }

struct PlyProperty {
  std::string name;
  PlyType type{};  ///< of the value, or of the list's items
  bool is_list = false;
  PlyType count_type{};  ///< of the list's length
};

struct PlyElement {
  std::string name;
  int64_t count = 0;
  int64_t header_line = 0;  ///< offset of its line, for messages
  std::vector<PlyProperty> properties;

  /// Index of the property, or -1.
  int find(const std::string& property) const;
  /// Binary bytes of a row whose lists are all empty.
  int64_t smallest_row_bytes() const;
  bool has_list() const;
};

/// Comments that hold more than words: names of images, as MeshLab writes them, of libraries of materials, labels,
/// regions, and what a frame was made of.
constexpr const char* kTextureNote = "TextureFile";
constexpr const char* kLibraryNote = "mtllib";
constexpr const char* kLabelNote = "label";           ///< followed by the attribute's name, the number and the label
constexpr const char* kRegionNote = "region";         ///< followed by the region's label and its name
constexpr const char* kFrameNote = "isoshell_frame";  ///< followed by what a frame of a sequence was made of
constexpr const char* kBackgroundNote = "region_background";  ///< followed by the label of what is no region

struct PlyHeader {
  PlyEncoding encoding{};
  std::vector<PlyElement> elements;
  int64_t body = 0;                             ///< offset of the first byte behind the header
  std::vector<std::vector<std::string>> notes;  ///< words of the comments that name files, labels or regions

  const PlyElement* find(const std::string& element) const;
};

/// Throws: unreadable_input; also when a count promises more rows than the rest of the file can hold.
PlyHeader read_ply_header(const MeshSource& source);

}  // namespace isoshell
