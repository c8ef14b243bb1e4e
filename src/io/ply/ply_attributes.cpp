#include "io/ply/ply_attributes.h"

#include <algorithm>

#include "core/attribute_values.h"
#include "io/bytes/text_scan.h"
#include "isoshell/error.h"

namespace isoshell {
namespace {

/// PLY's names of an attribute that has a meaning. How many components it has, the table of meanings says.
struct PlyNames {
  const char* name;
  std::vector<std::vector<const char*>> parts;  ///< of the components, where vertices have it; any of these are read
  bool writes_parts;                            ///< the first of them
  const char* list;                             ///< of a face, for its corners; null: these cannot have it
};

const std::vector<PlyNames>& ply_names_of_meanings() {
  static const std::vector<PlyNames> all = {
      {kColorName, {{"red", "green", "blue", "alpha"}}, true, nullptr},
      {kNormalName, {{"nx", "ny", "nz"}}, true, "normals"},
      // Pairs of names, since one of them alone may be anything; the list is MeshLab's.
      {kUvName, {{"s", "t"}, {"u", "v"}, {"texture_s", "texture_t"}, {"texture_u", "texture_v"}}, false, "texcoord"},
  };
  return all;
}

const PlyNames* names_of(const Attribute& a) {
  for (const PlyNames& names : ply_names_of_meanings())
    if (a.name == names.name && fitting_meaning(a)) return &names;
  return nullptr;
}

/// Numbers that are one attribute.
struct Family {
  std::string attribute;
  std::vector<std::string> parts;
};

/// The first of the parts that are there, as numbers of one type; none where there are too few for the attribute, or
/// another property has its name.
Family family_of(const PlyElement& element, const char* attribute, const std::vector<const char*>& parts) {
  Family family{attribute, {}};
  if (element.find(attribute) >= 0) return {};
  const PlyProperty* first = nullptr;
  for (const char* const part : parts) {
    const int at = element.find(part);
    if (at < 0) break;
    const PlyProperty& property = element.properties[size_t(at)];
    if (property.is_list || (first && property.type != first->type)) break;
    if (!first) first = &property;
    family.parts.push_back(part);
  }
  return int32_t(family.parts.size()) < meaning_of(attribute)->least_components ? Family{} : family;
}

class Finder {
 public:
  Finder(const PlyElement& element, AttributeDomain domain) : element_(element), domain_(domain) {
    for (const PlyNames& names : ply_names_of_meanings())
      if (domain == AttributeDomain::vertex || !names.list) add_family(names);
  }

  void take_number(int property) {
    const PlyProperty& p = element_.properties[size_t(property)];
    for (size_t f = 0; f < families_.size(); ++f)
      for (size_t part = 0; part < families_[f].parts.size(); ++part) {
        if (families_[f].parts[part] != p.name) continue;
        if (attribute_of_[f] == SIZE_MAX)
          attribute_of_[f] = add({families_[f].attribute, p.type, int32_t(families_[f].parts.size()), {}, domain_});
        found_.columns.push_back({property, attribute_of_[f], int32_t(part)});
        return;
      }
    found_.columns.push_back({property, add({p.name, p.type, 1, {}, domain_}), 0});
  }
  /// Whether it is one of the lists that are kept.
  bool take_list(int property) {
    const PlyProperty& p = element_.properties[size_t(property)];
    for (const PlyNames& names : ply_names_of_meanings()) {
      if (!names.list || p.name != names.list || !is_real(p.type)) continue;
      const int32_t components = meaning_of(names.name)->most_components;
      found_.lists.push_back(
          {property, add({names.name, p.type, components, {}, AttributeDomain::corner}), components});
      return true;
    }
    return false;
  }
  void drop(const std::string& name, const std::string& reason) { found_.dropped.push_back({name, reason}); }

  PlyAttributes take() { return std::move(found_); }

 private:
  void add_family(const PlyNames& names) {
    for (const std::vector<const char*>& parts : names.parts)
      if (Family family = family_of(element_, names.name, parts); !family.parts.empty()) {
        families_.push_back(std::move(family));
        attribute_of_.push_back(SIZE_MAX);
        return;
      }
  }
  size_t add(Attribute attribute) {
    found_.attributes.push_back(std::move(attribute));
    return found_.attributes.size() - 1;
  }

  const PlyElement& element_;
  AttributeDomain domain_;
  std::vector<Family> families_;
  std::vector<size_t> attribute_of_;  ///< per family, once one of its parts was taken
  PlyAttributes found_;
};

bool is_position(const std::string& name) { return name == "x" || name == "y" || name == "z"; }
bool is_corners(const std::string& name) { return name == "vertex_indices" || name == "vertex_index"; }

}  // namespace

PlyAttributes find_ply_attributes(const PlyElement& vertices) {
  Finder finder(vertices, AttributeDomain::vertex);
  for (int i = 0; i < int(vertices.properties.size()); ++i) {
    const PlyProperty& property = vertices.properties[size_t(i)];
    if (is_position(property.name)) continue;
    if (property.is_list)
      finder.drop(property.name, "lists are not kept");
    else if (property.name == "gap")
      finder.drop(property.name, "the result has its own flag of that name");
    else
      finder.take_number(i);
  }
  return finder.take();
}

PlyAttributes find_face_attributes(const PlyHeader& header, const PlyElement& faces) {
  Finder finder(faces, AttributeDomain::face);
  for (int i = 0; i < int(faces.properties.size()); ++i) {
    const PlyProperty& property = faces.properties[size_t(i)];
    if (!property.is_list)
      finder.take_number(i);
    else if (!finder.take_list(i) && !is_corners(property.name))
      finder.drop(property.name, "lists are not kept");
  }
  PlyAttributes found = finder.take();
  for (const std::vector<std::string>& note : header.notes) {
    if (note[0] != kLabelNote) continue;
    for (Attribute& a : found.attributes)
      if (a.name == note[1] && a.domain == AttributeDomain::face && a.components == 1 &&
          note[2] == std::to_string(a.labels.size()))
        a.labels.push_back(note[3]);
  }
  return found;
}

AttributeFiles find_files(const PlyHeader& header) {
  AttributeFiles files;
  for (const std::vector<std::string>& note : header.notes) {
    if (note[0] == kTextureNote) files.textures.push_back(note[1]);
    if (note[0] == kLibraryNote) files.materials.push_back(note[1]);
  }
  return files;
}

std::string ply_list_name(const Attribute& a) {
  if (const PlyNames* const names = names_of(a); names && names->list) return names->list;
  throw Error(ErrorCode::usage, "write_mesh",
              "PLY cannot hold the attribute '" + a.name + "' of corners; it holds texture coordinates and normals");
}

std::vector<std::string> ply_names(const Attribute& a) {
  if (const PlyNames* const names = names_of(a); names && names->writes_parts)
    return {names->parts[0].begin(), names->parts[0].begin() + a.components};
  const bool is_word =
      !a.name.empty() && std::all_of(a.name.begin(), a.name.end(), [](char c) { return c != '\n' && !is_blank(c); });
  if (a.components != 1 || !is_word)
    throw Error(ErrorCode::usage, "write_mesh",
                "PLY cannot hold the attribute '" + a.name + "' of " + std::to_string(a.components) +
                    " components; it holds words of one component, and the colour of 3 or 4");
  return {a.name};
}

}  // namespace isoshell
