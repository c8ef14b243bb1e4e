// The fixed seeds of a cut surface, which are on its curves.
#pragma once

#include "features/cut_surface.h"
#include "isoshell/seed_set.h"

namespace isoshell {

/// Fixed seeds at the places of curves that are seeds: one for each copy of the place, which is its home. Ids follow
/// (place, copy). A border vertex belongs to the seed that is nearest along its own curve, on its own side; of two that
/// are as near to the one of the smaller id. Coarser levels than 0 have every second of the places of the level before.
SeedSet seeds_on_curves(const CutSurface& cut, int level);

/// Places that the fixed seeds are at: vertices of the joined result.
int64_t count_places(const FixedSeeds& fixed);

}  // namespace isoshell
