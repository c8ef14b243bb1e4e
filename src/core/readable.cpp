#include "isoshell/readable.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>

namespace isoshell {
namespace {

constexpr int kFewestDigits = 6, kMostDigits = 17;
constexpr double kSmallestFixed = 1e-5, kLargestFixed = 1e16;  ///< of numbers without an exponent

/// `put` writes a number to a buffer and returns its end.
template <class Put>
std::string place_text(const WorldPoint& at, Put put) {
  std::string text;
  for (const double number : {at.x, at.y, at.z}) {
    char buffer[64];
    text += (text.empty() ? "" : " ") + std::string(buffer, put(buffer, buffer + sizeof buffer, number));
  }
  return text;
}

}  // namespace

std::string readable_place(const WorldPoint& at, double size_world) {
  return place_text(at, [&](char* begin, char* end, double number) {
    const double sizes = std::abs(number) / size_world;  // from the origin
    const int more = sizes > 1 && std::isfinite(sizes) ? int(std::ceil(std::log10(sizes))) : 0;
    const int digits = std::min(kFewestDigits + more, kMostDigits);
    return std::to_chars(begin, end, number, std::chars_format::general, digits).ptr;
  });
}

std::string readable_place(const WorldPoint& at, const WorldBox& box) {
  return readable_place(at, std::max({box.max.x - box.min.x, box.max.y - box.min.y, box.max.z - box.min.z}));
}

std::string readable_place(const WorldPoint& at, const LatticeFrame& frame) {
  return readable_place(at, frame.voxel_size * frame.resolution);
}

std::string exact_place(const WorldPoint& at) {
  return place_text(at, [](char* begin, char* end, double number) {
    const double size = std::abs(number);
    const bool is_short = size == 0 || (size >= kSmallestFixed && size < kLargestFixed);
    return std::to_chars(begin, end, number, is_short ? std::chars_format::fixed : std::chars_format::general).ptr;
  });
}

std::string with_commas(int64_t count) {
  std::string digits = std::to_string(count);
  for (int at = int(digits.size()) - 3; at > (count < 0 ? 1 : 0); at -= 3) digits.insert(size_t(at), ",");
  return digits;
}

std::string counted(int64_t count, const std::string& noun, const std::string& plural) {
  return with_commas(count) + " " + (count == 1 ? noun : plural.empty() ? noun + "s" : plural);
}

std::string readable_length(double length_world) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", length_world);
  return text;
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
