#include "io/gltf/gltf_uri.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <filesystem>

#include "core/parallel_ranges.h"

namespace isoshell {
namespace {

constexpr int64_t kGrain = 1 << 14;
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
  const char* const digits = uri.data() + mark + kMark.size();
  auto count = int64_t(uri.data() + uri.size() - digits);
  for (int i = 0; i < 2 && count > 0 && digits[count - 1] == '='; ++i) --count;
  if (count % 4 == 1) return {};
  std::vector<char> bytes(size_t(count * 3 / 4));
  // Three bytes of four digits, the last of which may be fewer; negative where one of them is no digit.
  const auto decode = [&](int64_t first, int64_t have) {
    int32_t bits = 0, signs = 0;
    for (int64_t i = 0; i < 4; ++i) {
      const int32_t value = i < have ? kValues[static_cast<unsigned char>(digits[first + i])] : 0;
      signs |= value;
      bits = bits << 6 | (value & 63);
    }
    for (int64_t i = 0; i < have - 1; ++i) bytes[size_t(first / 4 * 3 + i)] = char(bits >> (16 - 8 * i) & 0xff);
    return signs;
  };
  std::atomic<bool> is_sound = true;
  for_ranges(count / 4, kGrain, [&](int64_t begin, int64_t end) {
    int32_t signs = 0;
    for (int64_t group = begin; group < end; ++group) signs |= decode(4 * group, 4);
    if (signs < 0) is_sound = false;
  });
  if (decode(count / 4 * 4, count % 4) < 0 || !is_sound) return {};
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

bool lies_below(const std::string& folder, const std::string& file) {
  std::error_code code;
  const std::filesystem::path top = std::filesystem::canonical(folder.empty() ? "." : folder, code);
  const std::filesystem::path whole = std::filesystem::canonical(file, code);
  if (top.empty() || whole.empty()) return false;
  return std::mismatch(top.begin(), top.end(), whole.begin(), whole.end()).first == top.end();
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
