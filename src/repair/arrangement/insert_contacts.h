// Faces cut at their contacts.
#pragma once

#include "isoshell/backend.h"
#include "repair/arrangement/lattice_faces.h"

namespace isoshell::repair {

/// Makes one of points that are to be one: of two the one with the larger number goes. Faces without area are dropped;
/// those that changed, those in `found` and in `near_close` are unsettled then, and no others.
void weld_close(LatticeFaces& faces, const Contacts& contacts);

/// Puts the points of contacts, of which none are to be one, in edges and faces, and cuts these. Faces that were cut
/// are unsettled then, and no others; they follow in the place of the one that they are of.
void cut_at_contacts(LatticeFaces& faces, std::vector<Contact> contacts, const Context& context);

}  // namespace isoshell::repair
