// Scanning text at speed: numbers, tokens, and a file cut into chunks of whole lines.
#pragma once

#include <cstring>
#include <exception>
#include <string>
#include <string_view>
#include <vector>

#include "core/parallel_ranges.h"
#include "io/bytes/mesh_source.h"
#include "isoshell/advanced/lattice.h"

namespace isoshell {

inline bool is_blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r' && c != '\n'); }
inline bool is_digit(char c) { return c >= '0' && c <= '9'; }

inline const char* skip_blanks(const char* p, const char* end) {
  while (p < end && is_blank(*p)) ++p;
  return p;
}
inline const char* skip_token(const char* p, const char* end) {
  while (p < end && *p != '\n' && !is_blank(*p)) ++p;
  return p;
}
/// The line break that ends this line, or `end`.
inline const char* line_end(const char* p, const char* end) {
  const void* found = p < end ? std::memchr(p, '\n', size_t(end - p)) : nullptr;
  return found ? static_cast<const char*>(found) : end;
}
inline bool ends_token(const char* p, const char* end) { return p == end || *p == '\n' || is_blank(*p); }

/// What stands in the line behind p, without the blanks around it.
inline std::string_view rest_of_line(const char* p, const char* end) {
  p = skip_blanks(p, end);
  const char* last = line_end(p, end);
  while (last > p && is_blank(last[-1])) --last;
  return {p, size_t(last - p)};
}

bool parse_real_slowly(const char*& p, const char* end, double& value);

/// The double nearest to the decimal number at p, as std::from_chars gives it, and moves p behind it. Text for NaN and
/// infinity in any C library's spelling, and values out of range, give a NaN or an infinity. False: no number, p stays.
inline bool parse_real(const char*& p, const char* end, double& value) {
  // Up to 19 digits fit an integer; if it is below 2^53 and the power of ten is exact too, one rounding gives the
  // result.
  static constexpr double kPowerOfTen[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                           1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
  const char* s = p;
  const bool negative = s < end && *s == '-';
  s += negative;
  const char* const first = s;
  uint64_t digits = 0;
  while (s < end && is_digit(*s)) digits = 10 * digits + uint64_t(*s++ - '0');
  int64_t digit_count = s - first, exponent = 0;
  if (s < end && *s == '.') {
    const char* const fraction = ++s;
    while (s < end && is_digit(*s)) digits = 10 * digits + uint64_t(*s++ - '0');
    exponent = -(s - fraction);
    digit_count -= exponent;
  }
  if (s + 2 < end && (*s == 'e' || *s == 'E')) {
    const bool down = s[1] == '-';
    s += down || s[1] == '+' ? 2 : 1;
    int64_t power = 0;
    const char* const power_first = s;
    while (s < end && is_digit(*s) && power < 10000) power = 10 * power + (*s++ - '0');
    if (s == power_first) return parse_real_slowly(p, end, value);
    exponent += down ? -power : power;
  }
  if (digit_count == 0 || digit_count > 19 || digits > (uint64_t(1) << 53) || exponent < -22 || exponent > 22 ||
      !ends_token(s, end))
    return parse_real_slowly(p, end, value);
  const double exact = double(digits);
  const double magnitude = exponent < 0 ? exact / kPowerOfTen[-exponent] : exact * kPowerOfTen[exponent];
  value = negative ? -magnitude : magnitude;
  p = s;
  return true;
}

/// The integer at p, and moves p behind its digits; what follows is the caller's to judge. False: none, or too long.
inline bool parse_integer(const char*& p, const char* end, int64_t& value) {
  const char* s = p;
  const bool negative = s < end && *s == '-';
  s += negative || (s < end && *s == '+');
  const char* const first = s;
  uint64_t digits = 0;
  while (s < end && is_digit(*s)) digits = 10 * digits + uint64_t(*s++ - '0');
  if (s == first || s - first > 18) return false;
  value = negative ? -int64_t(digits) : int64_t(digits);
  p = s;
  return true;
}

/// The token at p for a message: quoted, cut short, unprintable bytes as '?'.
std::string quoted_token(const char* p, const char* end);

/// The words of a line, which ends at `end`.
std::vector<std::string> words_of(const char* p, const char* end);

/// A text file whose lines all end in '\n'. Old Macintosh line ends become '\n' and, where asked for, line
/// continuations become blanks; both keep every byte's place, so offsets are offsets into the file.
class Text {
 public:
  enum class Continuation { none, backslash };
  explicit Text(const MeshSource& source, Continuation continuation = Continuation::none);
  Text(const Text&) = delete;
  Text& operator=(const Text&) = delete;

  const MeshSource& source() const { return source_; }
  const char* begin() const { return begin_; }
  const char* end() const { return end_; }
  /// Throws unreadable_input naming the line of `at`.
  [[noreturn]] void refuse(const char* at, const std::string& what) const;

 private:
  void own();
  void join_continued_lines();

  const MeshSource& source_;
  std::vector<char> owned_;
  const char *base_, *begin_, *end_;
};

/// The three numbers of a vertex at p, which moves behind them. Throws: unreadable_input.
inline void read_point(const Text& text, const char*& p, const char* end, WorldPoint& point) {
  for (double* value : {&point.x, &point.y, &point.z}) {
    p = skip_blanks(p, end);
    if (!parse_real(p, end, *value))
      text.refuse(p, "a vertex needs three numbers; found " + quoted_token(p, end) + " instead of one");
  }
}

struct TextChunk {
  const char *begin, *end;
};
/// Cuts [begin, end) behind line breaks into pieces of about equal size, enough for all threads.
std::vector<TextChunk> split_at_lines(const char* begin, const char* end);

/// Runs work(i) for all i below count in parallel. Whichever fails first in time, the error of the smallest i is
/// thrown.
template <class Work>
void for_each_chunk(int64_t count, Work work) {
  std::vector<std::exception_ptr> errors(static_cast<size_t>(count));
  for_each_index(int64_t(0), count, [&](int64_t i) {
    try {
      work(i);
    } catch (...) {
      errors[size_t(i)] = std::current_exception();
    }
  });
  for (const std::exception_ptr& error : errors)
    if (error) std::rethrow_exception(error);
}

/// The lines that hold something (and do not begin with the comment character), numbered from 0 and found in parallel.
class TextRows {
 public:
  static constexpr char kNoComment = '\0';
  TextRows(const Text& text, const char* begin, char comment);

  int64_t count() const { return first_row_.back(); }
  int64_t chunk_count() const { return int64_t(chunks_.size()); }

  /// Calls read(row, p, end, chunk) for every row in [first, last), in parallel over chunks and in order within one.
  /// p is at the row's first character; `end` is beyond the line; read returns a place in the line, or its end.
  template <class Read>
  void for_each(int64_t first, int64_t last, Read read) const {
    for_each_chunk(chunk_count(), [&](int64_t c) {
      int64_t row = first_row_[size_t(c)];
      if (row >= last || first_row_[size_t(c) + 1] <= first) return;
      const char* p = chunks_[size_t(c)].begin;
      for (const char* const end = chunks_[size_t(c)].end; p < end && row < last; ++p) {
        p = skip_blanks(p, end);
        if (p < end && *p != '\n' && *p != comment_) {
          if (row >= first) p = read(row, p, end, c);
          ++row;
        }
        p = line_end(p, end);
      }
    });
  }

  /// Where the row begins, for messages. Cost: one chunk.
  const char* find(int64_t row) const;

 private:
  const char* begin_;
  char comment_;
  std::vector<TextChunk> chunks_;
  std::vector<int64_t> first_row_;  // one more than chunks
};

}  // namespace isoshell
