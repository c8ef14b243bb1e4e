// The points of contacts, by the edges and faces that they belong to.
#pragma once

#include "repair/arrangement/lattice_faces.h"

namespace isoshell::repair {

/// Gives each contact its point: a new one at the end of the faces' points, one for all contacts of the same edges and
/// face, or one nearby that is there already. Contacts are in another order then.
void number_new_points(LatticeFaces& faces, std::vector<Contact>& contacts);

/// Where a face is too low to be a triangle, what is on its longest edge is on the two others, too, and the other way
/// round, as far as that goes through such faces: it vanishes then, and leaves nothing between its neighbours.
void spread_over_low_faces(const LatticeFaces& faces, std::vector<Contact>& contacts);

/// Keeps a reference to the faces.
class ContactPoints {
 public:
  ContactPoints(const LatticeFaces& faces, const std::vector<Contact>& contacts);

  /// From one end to the other.
  std::vector<uint32_t> on_edge(uint32_t from, uint32_t to) const;
  /// Ascending.
  std::vector<uint32_t> inside(uint32_t face) const;
  /// Points that are on no edge and at no corner of a face go in it.
  void add_inside(std::vector<std::array<uint32_t, 2>> face_and_point);
  /// With points inside or on an edge; ascending.
  std::vector<uint32_t> touched_faces() const;

 private:
  struct OnEdge {
    uint64_t edge;  ///< its key
    double along;
    uint32_t point;
  };
  const LatticeFaces& faces_;
  std::vector<OnEdge> on_edge_;                  ///< by edge, then along it
  std::vector<std::array<uint32_t, 2>> inside_;  ///< face and point, ascending
  std::vector<uint8_t> is_end_;                  ///< per point: of an edge with points on it
};

}  // namespace isoshell::repair
