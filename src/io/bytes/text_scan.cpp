// Scanning text at speed: the parts that are not worth inlining.
#include "io/bytes/text_scan.h"

#include <algorithm>
#include <charconv>
#include <limits>

namespace isoshell {
namespace {

constexpr int64_t kLargestChunkBytes = 1 << 20, kSmallestChunkBytes = 1 << 12, kChunksWanted = 64;

// A decimal number that no double can hold: too small gives 0, too large infinity.
double out_of_range(const char* p, const char* end) {
  const char* exponent = std::find_if(p, end, [](char c) { return c == 'e' || c == 'E'; });
  if (exponent != end) return exponent + 1 < end && exponent[1] == '-' ? 0 : std::numeric_limits<double>::infinity();
  return *p == '0' || *p == '.' ? 0 : std::numeric_limits<double>::infinity();
}

}  // namespace

bool parse_real_slowly(const char*& p, const char* end, double& value) {
  const char* const token_end = skip_token(p, end);
  const char* s = p;
  const bool negative = s < token_end && *s == '-';
  s += s < token_end && (*s == '-' || *s == '+');
  if (s == token_end || *s == '-') return false;
  double magnitude = 0;
  const auto [stop, error] = std::from_chars(s, token_end, magnitude);
  if (error == std::errc::invalid_argument) return false;
  if (error == std::errc::result_out_of_range) magnitude = out_of_range(s, token_end);
  if (stop != token_end) {
    if (*stop != '#') return false;  // 1.#IND, 1.#QNAN, 1.#INF00 and their kin
    magnitude = std::numeric_limits<double>::quiet_NaN();
  }
  value = negative ? -magnitude : magnitude;
  p = token_end;
  return true;
}

std::string quoted_token(const char* p, const char* end) {
  constexpr int64_t kLongest = 40;
  const char* const stop = skip_token(p, end);
  if (p == stop) return "the end of the line";
  std::string text(p, std::min(stop, p + kLongest));
  for (char& c : text)
    if (c < ' ' || c > '~') c = '?';
  return "'" + text + (stop - p > kLongest ? "...'" : "'");
}

std::vector<std::string> words_of(const char* p, const char* end) {
  std::vector<std::string> words;
  for (p = skip_blanks(p, end); p < end; p = skip_blanks(p, end)) {
    const char* const word_end = skip_token(p, end);
    words.emplace_back(p, word_end);
    p = word_end;
  }
  return words;
}

Text::Text(const MeshSource& source, Continuation continuation)
    : source_(source), base_(source.begin()), begin_(source.begin()), end_(source.end()) {
  if (base_ == end_) return;
  const size_t size = size_t(source.size());
  if (!std::memchr(base_, '\n', size) && std::memchr(base_, '\r', size)) {
    own();
    std::replace(owned_.begin(), owned_.end(), '\r', '\n');
  }
  if (continuation == Continuation::backslash) join_continued_lines();
  if (size >= 3 && std::memcmp(base_, "\xEF\xBB\xBF", 3) == 0) begin_ += 3;
  if (std::memchr(begin_, '\0', std::min(size_t(end_ - begin_), size_t(1024))))
    source.refuse("holds zero bytes where text is expected; check that it is the format its name says");
}

void Text::own() {
  if (!owned_.empty()) return;
  source_.take(source_.size());
  owned_.assign(base_, end_);
  base_ = begin_ = owned_.data();
  end_ = base_ + owned_.size();
}

void Text::join_continued_lines() {
  int64_t joined_end = -1;  // a line joined so far ends here; no need to look for its beginning again
  for (const char* p = base_; p < end_; ++p) {
    p = static_cast<const char*>(std::memchr(p, '\\', size_t(end_ - p)));
    if (!p) return;
    const char* const stop = p + 1 < end_ && p[1] == '\r' ? p + 2 : p + 1;
    if (stop >= end_ || *stop != '\n') continue;
    const char* line = p;
    while (line > base_ && line[-1] != '\n' && line - base_ != joined_end) --line;
    if (line - base_ != joined_end && *skip_blanks(line, end_) == '#')
      continue;  // a comment that happens to end so (a Windows folder) stays alone
    const int64_t at = p - base_, length = stop + 1 - p;
    own();
    std::fill_n(owned_.begin() + at, length, ' ');
    joined_end = at + length;
    p = base_ + joined_end - 1;
  }
}

void Text::refuse(const char* at, const std::string& what) const { source_.refuse_line_at(at - base_, what); }

std::vector<TextChunk> split_at_lines(const char* begin, const char* end) {
  const int64_t wanted = std::clamp((end - begin) / kChunksWanted, kSmallestChunkBytes, kLargestChunkBytes);
  std::vector<TextChunk> chunks;
  for (const char* p = begin; p < end;) {
    const char* stop = end - p <= wanted ? end : line_end(p + wanted, end);
    if (stop < end) ++stop;
    chunks.push_back({p, stop});
    p = stop;
  }
  return chunks;
}

TextRows::TextRows(const Text& text, const char* begin, char comment)
    : begin_(begin), comment_(comment), chunks_(split_at_lines(begin, text.end())), first_row_(chunks_.size() + 1, 0) {
  for_each_chunk(chunk_count(), [&](int64_t c) {
    const char* const end = chunks_[size_t(c)].end;
    int64_t rows = 0;
    for (const char* p = chunks_[size_t(c)].begin; p < end; ++p) {
      p = skip_blanks(p, end);
      rows += p < end && *p != '\n' && *p != comment_;
      p = line_end(p, end);
    }
    first_row_[size_t(c) + 1] = rows;
  });
  for (size_t c = 1; c < first_row_.size(); ++c) first_row_[c] += first_row_[c - 1];
}

const char* TextRows::find(int64_t row) const {
  if (chunks_.empty()) return begin_;
  if (row >= count()) return chunks_.back().end;
  const auto above = std::upper_bound(first_row_.begin(), first_row_.end(), row);
  const TextChunk& chunk = chunks_[size_t(above - first_row_.begin()) - 1];
  int64_t at = above[-1];
  for (const char* p = chunk.begin; p < chunk.end; ++p) {
    p = skip_blanks(p, chunk.end);
    if (p < chunk.end && *p != '\n' && *p != comment_ && at++ == row) return p;
    p = line_end(p, chunk.end);
  }
  return chunk.end;
}

}  // namespace isoshell
