// The format of a file, as its name or a person says it.
#pragma once

#include <algorithm>
#include <cctype>
#include <string>

namespace isoshell {

inline std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return text;
}

/// "PLY" and ".ply" as "ply".
inline std::string format_name(const std::string& format) {
  return lower_case(!format.empty() && format[0] == '.' ? format.substr(1) : format);
}

/// What stands behind the last dot of the file's name; empty without one.
inline std::string format_of_path(const std::string& path) {
  const size_t slash = path.find_last_of('/'), dot = path.find_last_of('.');
  return dot == std::string::npos || (slash != std::string::npos && dot < slash) ? "" : format_name(path.substr(dot));
}

}  // namespace isoshell
