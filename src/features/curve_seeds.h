// Seeds of a cut surface: fixed ones on its curves, and free ones in its patches.
#pragma once

#include "features/cut_surface.h"
#include "isoshell/seed_set.h"

namespace isoshell {

/// Fixed seeds that cut every curve into segments of equal arclength, of about the edge length. Result: every corner is
/// one, and on each curve the places nearest to where segments end; a place has a seed for each of its copies, which is
/// its home. Ids follow (place, copy). A border vertex belongs to the seed that is nearest along its own curve, on its
/// own side; of two that are as near to the one of the smaller id. An edge length above that of the cut surface gives
/// seeds for a coarser level.
SeedSet seeds_on_curves(const CutSurface& cut, double edge_length_world);

/// Places that the fixed seeds are at: vertices of the joined result.
int64_t count_places(const FixedSeeds& fixed);

/// Seeds inside of the patches, behind the fixed ones: as many as it takes for `vertices` places in all, where seeds
/// that are joined are one place. Patches share them by what Euler's formula leaves for their inside: a patch with area
/// A, a border of b seeds and Euler characteristic x has 2 / sqrt(3) A / e^2 - b / 2 + x inner vertices. In a patch
/// they are spread as place_seeds does it, each in a triangle that has a vertex off the border, which is its home.
/// Throws: usage when the fixed seeds alone are more than that, or cells would have fewer than two vertices.
SeedSet add_free_seeds(const CutSurface& cut, SeedSet fixed, int64_t vertices, uint64_t seed);

}  // namespace isoshell
