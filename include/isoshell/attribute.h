// What a surface carries beside its positions: colours, texture coordinates, normals, materials, any other numbers.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace isoshell {

/// How a file holds a number.
enum class NumberType { i8, u8, i16, u16, i32, u32, f32, f64 };

/// What has a value of an attribute of its own. Corner i of triangle t is corner 3 t + i.
enum class AttributeDomain : uint8_t { vertex, corner, face };

/// Names of attributes with a meaning.
constexpr const char* kColorName = "color";        ///< red, green, blue and possibly alpha; integers are parts of the
                                                   ///< largest value of their type
constexpr const char* kUvName = "uv";              ///< texture coordinates, of corners
constexpr const char* kTextureName = "texnumber";  ///< of faces: place in AttributeFiles::textures
constexpr const char* kNormalName = "normal";  ///< outward directions, of corners: of any length in a source, and of
                                               ///< length 1 in a result
constexpr const char* kMaterialName = "material";  ///< of faces, with labels
constexpr const char* kGroupName = "group";
constexpr const char* kObjectName = "object";

struct Attribute {
  std::string name;
  NumberType type = NumberType::f32;
  int32_t components = 1;
  std::vector<double> values;  ///< `components` of them each; of corners NaN where a file has none
  AttributeDomain domain = AttributeDomain::vertex;
  std::vector<uint32_t> index = {};      ///< per corner its value; empty, as for vertices and faces: each has its own
  std::vector<std::string> labels = {};  ///< what a value is the number of, -1 being none; empty: values are numbers
};

/// What a name says of an attribute. Others may hold any numbers.
struct AttributeMeaning {
  const char* name;
  AttributeDomain domain;
  int32_t least_components, most_components;
  bool has_sets = false;      ///< name1, name2, ... mean the same
  bool is_direction = false;  ///< its first three components are one, which a result has with length 1
  bool makes_seams = false;   ///< where it jumps, no triangle of a result may lie on both sides; labels of
                              ///< faces always do
};

const std::vector<AttributeMeaning>& attribute_meanings();

/// By the name alone, "uv2" as well as "uv"; null for one without a meaning.
const AttributeMeaning* meaning_of(const std::string& name);

/// Whether the attribute is of that meaning, by its name, domain and components.
bool means(const Attribute& attribute, const char* name);

/// What attributes speak of, as it stands in the file that was read: names of files, and materials.
struct AttributeFiles {
  std::vector<std::string> materials;  ///< libraries of OBJ's materials
  std::vector<std::string> textures;   ///< images, in the order of their numbers
  /// glTF's materials, as many as the attribute has labels, with their textures, samplers and images: lists of a JSON
  /// object as glTF has them, with images in "data:" URIs or in files; empty for none.
  std::string gltf_materials;
};

/// What a file has and the result has not.
struct DroppedAttribute {
  std::string name, reason;
};

}  // namespace isoshell
