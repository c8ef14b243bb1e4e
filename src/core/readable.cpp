#include "isoshell/readable.h"

#include <cstdio>

namespace isoshell {

std::string with_commas(int64_t count) {
  std::string digits = std::to_string(count);
  for (int at = int(digits.size()) - 3; at > (count < 0 ? 1 : 0); at -= 3) digits.insert(size_t(at), ",");
  return digits;
}

std::string counted(int64_t count, const std::string& noun, const std::string& plural) {
  return with_commas(count) + " " + (count == 1 ? noun : plural.empty() ? noun + "s" : plural);
}

std::string readable_bytes(int64_t bytes) {
  const char* units[] = {"B", "KiB", "MiB", "GiB", "TiB"};
  double value = double(bytes);
  int unit = 0;
  while (value >= 1024 && unit < 4) {
    value /= 1024;
    ++unit;
  }
  char text[32];
  std::snprintf(text, sizeof text, unit == 0 ? "%.0f %s" : "%.1f %s", value, units[unit]);
  return text;
}

}  // namespace isoshell
