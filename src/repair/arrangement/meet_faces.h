// Where two faces meet beside the corners and edges that they share.
#pragma once

#include "repair/arrangement/lattice_faces.h"

namespace isoshell::repair {

/// Adds the contacts of two faces; where they have points that are to be one, these alone.
void meet_faces(const LatticeFaces& faces, uint32_t f, uint32_t g, Contacts& to);

/// Adds the contact of a face with itself, if it is too low to be a triangle: its apex in its longest edge, or corners
/// that are to be one. Result: whether it is.
bool meet_itself(const LatticeFaces& faces, uint32_t f, Contacts& to);

}  // namespace isoshell::repair
