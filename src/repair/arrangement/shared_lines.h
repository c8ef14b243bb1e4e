// The lines that two faces have in common, as edges between points of contacts.
#pragma once

#include "repair/arrangement/new_points.h"

namespace isoshell::repair {

/// A line in a face that is to be an edge of its parts.
struct FaceLine {
  uint32_t face;
  Ends ends;

  bool operator<(const FaceLine& o) const { return face != o.face ? face < o.face : ends < o.ends; }
  bool operator==(const FaceLine& o) const { return face == o.face && ends == o.ends; }
};

/// Ascending, each once. Points of one face that lie between points of an edge of it which are in the other are in that
/// as well, and are added to `points`.
std::vector<FaceLine> shared_lines(const LatticeFaces& faces, const std::vector<Contact>& contacts,
                                   ContactPoints& points);

}  // namespace isoshell::repair
