// glTF's names of attributes that have a meaning, for reader and writer.
#pragma once

#include <string>

#include "isoshell/attribute.h"

namespace isoshell {

/// The name of the attribute that a semantic is, "uv1" of "TEXCOORD_1"; empty for one without a meaning of ours.
std::string name_of_semantic(const std::string& semantic);

/// glTF's name, less the number of a set; null where it has none.
const char* semantic_of_name(const std::string& name);

/// 0 for "uv", 7 for "uv7", -1 for what has no sets.
int set_of_name(const std::string& name);

}  // namespace isoshell
