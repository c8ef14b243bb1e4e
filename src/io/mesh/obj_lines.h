// What a line of an OBJ file holds.
#pragma once

#include <string>

#include "io/bytes/text_scan.h"

namespace isoshell {

enum class ObjLine { other, vertex, texture, normal, face, line, object, group, material, library };

/// p moves behind the keyword.
inline ObjLine classify(const char*& p, const char* end) {
  p = skip_blanks(p, end);
  if (p == end) return ObjLine::other;
  const char* const keyword = p;
  if (ends_token(p + 1, end)) {
    ++p;
    switch (*keyword) {
      case 'v':
        return ObjLine::vertex;
      case 'f':
        return ObjLine::face;
      case 'l':
        return ObjLine::line;
      case 'g':
        return ObjLine::group;
      case 'o':
        return ObjLine::object;
      default:
        return ObjLine::other;
    }
  }
  if (*keyword != 'v' && *keyword != 'u' && *keyword != 'm') return ObjLine::other;
  p = skip_token(p, end);
  const auto is = [&](const char* word) { return std::string(keyword, p) == word; };
  if (p - keyword == 2 && *keyword == 'v')
    return keyword[1] == 't' ? ObjLine::texture : keyword[1] == 'n' ? ObjLine::normal : ObjLine::other;
  if (p - keyword != 6) return ObjLine::other;
  return is("usemtl") ? ObjLine::material : is("mtllib") ? ObjLine::library : ObjLine::other;
}

/// What stands in the line behind p, without the blanks around it.
inline std::string rest_of_line(const char* p, const char* end) {
  p = skip_blanks(p, end);
  const char* last = line_end(p, end);
  while (last > p && is_blank(last[-1])) --last;
  return {p, last};
}

}  // namespace isoshell
