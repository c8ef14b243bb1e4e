// What a uri of a glTF file stands for: data of its own, or a file beside it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "isoshell/advanced/buffer.h"

namespace isoshell {

/// The bytes of "data:...;base64,..."; none where that is not sound.
std::optional<std::vector<char>> decoded_data(const std::string& uri);
/// A relative path with its %-codes resolved; none for what leads elsewhere: other schemes, absolute paths, "..".
std::optional<std::string> file_name_of(const std::string& uri);
/// Whether a file lies in a folder or below it once symbolic links are followed; an empty name is the current folder.
bool lies_below(const std::string& folder, const std::string& file);
std::string base64_of(View<const char> bytes);

}  // namespace isoshell
