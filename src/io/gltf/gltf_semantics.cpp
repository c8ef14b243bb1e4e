#include "io/gltf/gltf_semantics.h"

#include <cstring>

namespace isoshell {
namespace {

struct Semantic {
  const char* semantic;  ///< of one that has sets without its number
  const char* name;
};
constexpr Semantic kSemantics[] = {{"COLOR_0", kColorName}, {"NORMAL", kNormalName}, {"TEXCOORD_", kUvName}};

}  // namespace

std::string name_of_semantic(const std::string& semantic) {
  for (const Semantic& s : kSemantics) {
    if (semantic == s.semantic) return meaning_of(s.name)->has_sets ? "" : s.name;
    const size_t size = std::strlen(s.semantic);
    if (!meaning_of(s.name)->has_sets || semantic.compare(0, size, s.semantic) != 0) continue;
    const std::string set = semantic.substr(size), name = set == "0" ? s.name : s.name + set;
    if (meaning_of(name)) return name;
  }
  return "";
}

const char* semantic_of_name(const std::string& name) {
  const AttributeMeaning* const meaning = meaning_of(name);
  for (const Semantic& s : kSemantics)
    if (meaning && std::strcmp(meaning->name, s.name) == 0) return s.semantic;
  return nullptr;
}

int set_of_name(const std::string& name) {
  const AttributeMeaning* const meaning = meaning_of(name);
  if (!meaning || !meaning->has_sets) return -1;
  const std::string set = name.substr(std::strlen(meaning->name));
  return set.empty() ? 0 : std::stoi(set);
}

}  // namespace isoshell
