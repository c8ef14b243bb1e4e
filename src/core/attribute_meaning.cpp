// The table of attributes that have a meaning. Formats have names of their own for them, in their own files.
#include <cstring>

#include "core/attribute_values.h"

namespace isoshell {
namespace {

constexpr size_t kMostDigits = 3;  // of the number of a set

bool is_set_of(const std::string& name, const char* family) {
  const size_t size = std::strlen(family);
  const std::string digits = name.compare(0, size, family) == 0 ? name.substr(size) : "";
  return !digits.empty() && digits.size() <= kMostDigits && digits.find_first_not_of("0123456789") == std::string::npos;
}

}  // namespace

const std::vector<AttributeMeaning>& attribute_meanings() {
  static const std::vector<AttributeMeaning> all = {
      // name, domain, components, sets, direction, seams
      {kColorName, AttributeDomain::vertex, 3, 4},
      {kUvName, AttributeDomain::corner, 2, 2, true, false, true},
      {kNormalName, AttributeDomain::corner, 3, 3, false, true},
      {kTextureName, AttributeDomain::face, 1, 1, false, false, true},
      {kMaterialName, AttributeDomain::face, 1, 1},
      {kGroupName, AttributeDomain::face, 1, 1},
      {kObjectName, AttributeDomain::face, 1, 1},
  };
  return all;
}

const AttributeMeaning* meaning_of(const std::string& name) {
  for (const AttributeMeaning& meaning : attribute_meanings())
    if (name == meaning.name || (meaning.has_sets && is_set_of(name, meaning.name))) return &meaning;
  return nullptr;
}

const AttributeMeaning* fitting_meaning(const Attribute& a) {
  const AttributeMeaning* const meaning = meaning_of(a.name);
  const bool fits = meaning && a.components >= meaning->least_components && a.components <= meaning->most_components;
  return fits ? meaning : nullptr;
}

bool means(const Attribute& a, const char* name) {
  const AttributeMeaning* const meaning = fitting_meaning(a);
  return meaning && std::strcmp(meaning->name, name) == 0 && a.domain == meaning->domain;
}

}  // namespace isoshell
