// The materials of a glTF file, which faces name: they pass from file to file as they are.
#pragma once

#include <string>
#include <vector>

#include "io/gltf/gltf_document.h"

namespace isoshell {

/// What AttributeFiles::gltf_materials holds; empty where materials have nothing but names.
std::string gltf_materials_of(const GltfDocument& document);

/// Adds materials to a document that is written, and images that have bytes of their own to its buffer and views.
/// `text` is as of gltf_materials_of; where it is empty, materials get `names` alone. Keeps `bytes` a multiple of 4.
/// Throws: usage, where the text does not hold as many materials as there are names.
void put_gltf_materials(const std::string& text, const std::vector<std::string>& names,
                        nlohmann::ordered_json& document, std::vector<char>& bytes);

}  // namespace isoshell
