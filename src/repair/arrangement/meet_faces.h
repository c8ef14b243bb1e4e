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

/// A face's own plane, and those across it through its edges: what lies beyond one of these is above it.
struct FacePlanes {
  HeightPlane face;
  std::array<HeightPlane, 3> edge;
};
FacePlanes planes_of(const LatticeFaces& faces, uint32_t f);

/// A face and its planes, which many pairs have in common.
struct FaceAndPlanes {
  uint32_t number;
  const FacePlanes& planes;
};

/// Adds the contacts of two faces; where they have points that are to be one, these alone.
void meet_faces(const LatticeFaces& faces, const FaceAndPlanes& f, const FaceAndPlanes& g, Contacts& to);

/// Adds the contact of a face with itself, if it is too low to be a triangle: its apex in its longest edge, or corners
/// that are to be one. Result: whether it is.
bool meet_itself(const LatticeFaces& faces, uint32_t f, Contacts& to);

}  // namespace isoshell::repair
