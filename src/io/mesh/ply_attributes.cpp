#include "io/mesh/ply_attributes.h"

#include <algorithm>

#include "io/text_scan.h"
#include "isoshell/error.h"

namespace isoshell {
namespace {

constexpr const char* kColorParts[] = {"red", "green", "blue", "alpha"};
/// Pairs of names, since one of them alone may be anything.
constexpr const char* kTexturePairs[][2] = {
    {"s", "t"}, {"u", "v"}, {"texture_s", "texture_t"}, {"texture_u", "texture_v"}};

bool has_number(const PlyElement& vertices, const char* name) {
  const int i = vertices.find(name);
  return i >= 0 && !vertices.properties[size_t(i)].is_list;
}

/// How many of red, green, blue and alpha make the colour: 0, 3 or 4.
int32_t color_components(const PlyElement& vertices) {
  if (vertices.find(kColorName) >= 0 || !has_number(vertices, kColorParts[0])) return 0;
  const PlyType type = vertices.properties[size_t(vertices.find(kColorParts[0]))].type;
  int32_t count = 1;
  while (count < 4 && has_number(vertices, kColorParts[count]) &&
         vertices.properties[size_t(vertices.find(kColorParts[count]))].type == type)
    ++count;
  return count < 3 ? 0 : count;
}

/// Empty for a property that is kept.
std::string reason_to_drop(const PlyElement& vertices, const PlyProperty& property) {
  const std::string& name = property.name;
  if (property.is_list) return "lists are not kept";
  if (name == "nx" || name == "ny" || name == "nz") return "normals are not kept, the result has its own";
  if (name == "gap") return "the result has its own flag of that name";
  for (const auto& pair : kTexturePairs)
    if ((name == pair[0] || name == pair[1]) && has_number(vertices, pair[0]) && has_number(vertices, pair[1]))
      return "texture coordinates are not kept";
  return "";
}

}  // namespace

PlyAttributes find_ply_attributes(const PlyElement& vertices) {
  PlyAttributes found;
  const int32_t color_size = color_components(vertices);
  size_t color = SIZE_MAX;
  const auto attribute = [&](const std::string& name, PlyType type, int32_t components) {
    found.attributes.push_back({name, type, components, {}});
    return found.attributes.size() - 1;
  };
  for (int i = 0; i < int(vertices.properties.size()); ++i) {
    const PlyProperty& property = vertices.properties[size_t(i)];
    if (property.name == "x" || property.name == "y" || property.name == "z") continue;
    const auto part = int32_t(std::find(kColorParts, kColorParts + color_size, property.name) - kColorParts);
    if (part < color_size) {
      if (color == SIZE_MAX) color = attribute(kColorName, property.type, color_size);
      found.columns.push_back({i, color, part});
    } else if (const std::string reason = reason_to_drop(vertices, property); !reason.empty()) {
      found.dropped.push_back({property.name, reason});
    } else {
      found.columns.push_back({i, attribute(property.name, property.type, 1), 0});
    }
  }
  return found;
}

std::vector<std::string> ply_names(const VertexAttribute& a) {
  if (a.name == kColorName && (a.components == 3 || a.components == 4))
    return {kColorParts, kColorParts + a.components};
  const bool is_word =
      !a.name.empty() && std::all_of(a.name.begin(), a.name.end(), [](char c) { return c != '\n' && !is_blank(c); });
  if (a.components != 1 || !is_word)
    throw Error(ErrorCode::usage, "write_mesh",
                "PLY cannot hold the attribute '" + a.name + "' of " + std::to_string(a.components) +
                    " components; it holds words of one component, and the colour of 3 or 4");
  return {a.name};
}

}  // namespace isoshell
