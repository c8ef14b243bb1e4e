// All contacts of faces with those that are near to them.
#pragma once

#include "isoshell/backend.h"
#include "repair/arrangement/lattice_faces.h"

namespace isoshell::repair {

/// Of the pairs of faces of which one is unsettled, and of these with themselves; in an order that is independent of
/// threads. Throws: interrupted. Cost: a tree of the unsettled faces, for every other one a look at its root, and the
/// pairs whose boxes meet. Where that is more than `most_work`, less may be found; work() is more than that then.
Contacts find_contacts(const LatticeFaces& faces, int64_t most_work, const Context& context);

/// Of the same pairs those that intersect outside of what they share, exactly: these faces are unsettled then, and
/// those without area, and no others. Throws: interrupted. Cost: the same.
void unsettle_crossing(LatticeFaces& faces, const Context& context);

}  // namespace isoshell::repair
