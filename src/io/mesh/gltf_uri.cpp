#include "io/mesh/gltf_uri.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>

namespace isoshell {
namespace {

constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

std::array<int8_t, 256> values_of_digits() {
  std::array<int8_t, 256> values;
  values.fill(-1);
  for (int i = 0; i < 64; ++i) values[size_t(kDigits[i])] = int8_t(i);
  return values;
}

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  c = char(c | 0x20);
  return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

}  // namespace

std::optional<std::vector<char>> decoded_data(const std::string& uri) {
  static const std::array<int8_t, 256> kValues = values_of_digits();
  static const std::string kMark = ";base64,";
  const size_t mark = uri.find(kMark);
  if (mark == std::string::npos) return {};
  size_t begin = mark + kMark.size(), end = uri.size();
  for (int i = 0; i < 2 && end > begin && uri[end - 1] == '='; ++i) --end;
  if ((end - begin) % 4 == 1) return {};
  std::vector<char> bytes;
  bytes.reserve((end - begin) * 3 / 4);
  uint32_t bits = 0;
  int count = 0;
  for (; begin < end; ++begin) {
    const int8_t value = kValues[static_cast<unsigned char>(uri[begin])];
    if (value < 0) return {};
    bits = bits << 6 | uint32_t(value);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes.push_back(char(bits >> count & 0xff));
  }
  return bytes;
}

std::optional<std::string> file_name_of(const std::string& uri) {
  std::string name;
  for (size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] != '%') {
      name += uri[i];
      continue;
    }
    const int high = i + 2 < uri.size() ? hex_digit(uri[i + 1]) : -1, low = high < 0 ? -1 : hex_digit(uri[i + 2]);
    if (low < 0) return {};
    name += char(high << 4 | low);
    i += 2;
  }
  const std::filesystem::path path(name);
  if (name.empty() || path.is_absolute() || name.find('\0') != std::string::npos) return {};
  if (uri.substr(0, uri.find('/')).find(':') != std::string::npos) return {};
  if (std::find(path.begin(), path.end(), "..") != path.end()) return {};
  return name;
}

std::string base64_of(View<const char> bytes) {
  std::string text;
  text.reserve(size_t(bytes.size + 2) / 3 * 4);
  for (int64_t i = 0; i < bytes.size; i += 3) {
    uint32_t bits = 0;
    for (int64_t k = 0; k < 3; ++k)
      bits = bits << 8 | (i + k < bytes.size ? static_cast<unsigned char>(bytes.data[i + k]) : 0u);
    for (int64_t k = 0; k < 4; ++k) text += i + k <= bytes.size ? kDigits[bits >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

}  // namespace isoshell
