// Small records as text, "name=value name=value": readable in any viewer, exact for doubles, independent of the locale.
#pragma once

#include <charconv>
#include <cstdint>
#include <string>
#include <system_error>
#include <type_traits>

namespace isoshell {

/// Doubles are written as hexadecimal floating point without prefix, as std::to_chars gives it.
class KeyValueWriter {
 public:
  template <class T>
  KeyValueWriter& add(const char* name, T value) {
    char text[64];
    std::to_chars_result end;
    if constexpr (std::is_floating_point_v<T>)
      end = std::to_chars(text, text + sizeof text, value, std::chars_format::hex);
    else
      end = std::to_chars(text, text + sizeof text, int64_t(value));
    if (!text_.empty()) text_ += ' ';
    text_ += name;
    text_ += '=';
    text_.append(text, end.ptr);
    return *this;
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

/// Reads what KeyValueWriter wrote. A missing or malformed value makes ok() false and leaves the target alone.
class KeyValueReader {
 public:
  explicit KeyValueReader(const std::string& text) : text_(' ' + text) {}

  template <class T>
  KeyValueReader& get(const char* name, T& value) {
    const std::string start = std::string(" ") + name + "=";
    const size_t found = text_.find(start);
    if (found == std::string::npos) return fail();
    const char* begin = text_.data() + found + start.size();
    const char* end = text_.data() + text_.size();
    T parsed{};
    std::from_chars_result at;
    if constexpr (std::is_floating_point_v<T>)
      at = std::from_chars(begin, end, parsed, std::chars_format::hex);
    else
      at = std::from_chars(begin, end, parsed);
    if (at.ec != std::errc() || (at.ptr != end && *at.ptr != ' ')) return fail();
    value = parsed;
    return *this;
  }
  KeyValueReader& get(const char* name, bool& value) {
    int number = value;
    get(name, number);
    if (number != 0 && number != 1) return fail();
    value = number == 1;
    return *this;
  }
  bool ok() const { return ok_; }

 private:
  KeyValueReader& fail() {
    ok_ = false;
    return *this;
  }

  std::string text_;
  bool ok_ = true;
};

}  // namespace isoshell
