#include "io/gltf/json_size.h"

#include <algorithm>
#include <cstring>

namespace isoshell {
namespace {

constexpr int64_t kValueBytes = 64, kMemberBytes = 96;  // in memory, beside letters; lists have room for more

const char* find_char(const char* p, const char* end, char c) {
  const void* const at = std::memchr(p, c, size_t(end - p));
  return at ? static_cast<const char*>(at) : end;
}

/// The quote that ends a string of JSON, or `end`; p is behind the quote that begins it.
const char* end_of_string(const char* p, const char* end) {
  for (const char* quote = p;; quote = std::max(quote, p)) {
    if (quote == p) quote = find_char(p, end, '"');
    const char* const escape = find_char(p, quote, '\\');
    if (escape == quote) return quote;
    if (end - escape <= 2) return end;
    p = escape + 2;  // what follows a backslash is no end
  }
}

}  // namespace

JsonSize json_size_of(View<const char> text, int most_depth) {
  JsonSize most{0, text.size};
  int depth = 0;
  for (const char* p = text.begin(); p < text.end() && most.depth <= most_depth; ++p) {
    depth += (*p == '[' || *p == '{') - (*p == ']' || *p == '}');
    most.depth = std::max(most.depth, depth);
    if (*p == ',' || *p == '[' || *p == '{') most.bytes += kValueBytes;
    if (*p == ':') most.bytes += kMemberBytes;
    if (*p == '"') p = end_of_string(p + 1, text.end());
    if (p == text.end()) break;
  }
  return most;
}

}  // namespace isoshell
