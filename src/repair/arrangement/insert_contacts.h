// Faces cut at their contacts.
#pragma once

#include "isoshell/backend.h"
#include "repair/arrangement/lattice_faces.h"

namespace isoshell::repair {

/// Makes one of points that are to be one: of two the one with the larger number goes. Faces without area are dropped;
/// those that changed, and those that `contacts` name, are unsettled then, and no others.
void weld_close(LatticeFaces& faces, const Contacts& contacts);

/// Puts the points of contacts, of which none are to be one, in edges and faces, and cuts these. Faces that were cut,
/// or that `contacts` name, are unsettled then, and no others; pieces follow in the place of the one that they are of.
void cut_at_contacts(LatticeFaces& faces, Contacts contacts, const Context& context);

/// Faces that `contacts` name are unsettled then, and no others.
void unsettle_named(LatticeFaces& faces, const Contacts& contacts);

}  // namespace isoshell::repair
