// What a line of an OBJ file holds.
#pragma once

#include <cstdint>
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

/// How messages speak of an index: who names it, and what it is the index of.
struct ObjReference {
  const char *who, *what, *plural;
};

/// Of what is named, from 1 on or, when negative, from the last one on; 0-based. Throws: unreadable_input.
inline uint32_t resolve(const Text& text, const char* token, const ObjReference& names, int64_t index, int64_t so_far,
                        int64_t count) {
  const int64_t found = index < 0 ? so_far + index : index - 1;
  if (index == 0 || found < 0 || found >= count)
    text.refuse(token,
                std::string(names.who) + " names " + names.what + " " + std::to_string(index) + "; " +
                    (index < 0 ? std::to_string(so_far) + " " + names.plural + " come before it, so -1 to -" +
                                     std::to_string(so_far)
                               : std::string("the file holds ") + names.plural + " 1 to " + std::to_string(count)) +
                    "; correct the index or restore the missing " + names.plural);
  return uint32_t(found);
}

}  // namespace isoshell
