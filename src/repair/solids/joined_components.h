// Which closed surfaces pass through each other: together they bound one solid.
#pragma once

#include "isoshell/advanced/lattice_surface.h"
#include "isoshell/advanced/site_set.h"

namespace isoshell {

/// By how many the components of a surface become fewer when those are one whose triangles share a point or intersect,
/// exactly decided. Components that vanished in snapping do not count. Both products are in host memory. Cost: a sort
/// of the edges, and the pairs of triangles in sites that see more than one component.
int64_t count_joins(const LatticeSurface& surface, const SiteSamples& samples);

}  // namespace isoshell
