// Which closed surfaces pass through each other: together they bound one solid.
#pragma once

#include "isoshell/lattice_surface.h"
#include "isoshell/site_set.h"

namespace isoshell {

/// Number of components of a surface when those are one whose triangles share a point or intersect, exactly decided.
/// Both products are in host memory. Cost: the pairs of triangles in sites that
/// see more than one component.
int64_t count_joined_components(const LatticeSurface& surface, const SiteSamples& samples);

}  // namespace isoshell
