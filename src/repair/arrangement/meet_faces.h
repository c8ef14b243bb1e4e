// Where two faces meet beside the corners and edges that they share.
#pragma once

#include "geometry/world_vector.h"
#include "repair/arrangement/lattice_faces.h"

namespace isoshell::repair {

/// A plane with points above it, by their heights.
struct HeightPlane {
  WorldPoint normal = {0, 0, 0};  ///< of length 1; none of a face without area
  double offset = 0;

  double height(const WorldPoint& p) const { return dot(normal, p) - offset; }
};

/// A face with what many pairs ask of it.
struct FacePlanes {
  uint32_t number;
  Corners corner;
  std::array<WorldPoint, 3> at;
  HeightPlane plane;
  std::array<HeightPlane, 3> across_edge;  ///< what lies beyond edge i is above the i-th
};
FacePlanes planes_of(const LatticeFaces& faces, uint32_t f);

/// Adds the contacts of two faces; where they have points that are to be one, these alone. Of faces that intersect,
/// which is decided exactly, something is added.
void meet_faces(const LatticeFaces& faces, const FacePlanes& f, const FacePlanes& g, Contacts& to);

bool has_area(const LatticeFaces& faces, uint32_t f);

/// Adds the contact of a face with itself, if it is too low to be a triangle: its apex in its longest edge, or corners
/// that are to be one. Result: whether it is.
bool meet_itself(const LatticeFaces& faces, uint32_t f, Contacts& to);

}  // namespace isoshell::repair
