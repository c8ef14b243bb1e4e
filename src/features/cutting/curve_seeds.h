// The fixed seeds of a cut surface, which are on its curves.
#pragma once

#include "features/cutting/cut_surface.h"
#include "isoshell/advanced/seed_set.h"

namespace isoshell {

/// Which places of a curve are seeds on a level: its own on level 0, every second segment's ends on each coarser one.
std::vector<size_t> seeds_of_level(const CutCurve& curve, int level);

/// Fixed seeds at the places of curves that are seeds: one for each copy of the place, which is its home. Ids follow
/// (place, copy). A border vertex belongs to the seed that is nearest along its own curve, on its own side; of two that
/// are as near to the one of the smaller id. Coarser levels than 0 have every second of the places of the level before.
SeedSet seeds_on_curves(const CutSurface& cut, int level);

/// Places that the fixed seeds are at: vertices of the joined result.
int64_t count_places(const FixedSeeds& fixed);

}  // namespace isoshell
