// The repair of a surface that stays open.
#pragma once

#include "isoshell/repair.h"

namespace isoshell::repair {

/// As repair_soup, but that it closes the loops whose caps are this wide or less, whatever they bound, and no others;
/// and that small open patches stay, as they have borders to keep.
TriangleSoup repair_open_soup(const TriangleSoup& soup, double widest_gap_world, RepairReport& report);

}  // namespace isoshell::repair
