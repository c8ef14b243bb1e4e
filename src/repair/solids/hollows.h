// Where the hollows of a closed surface are that inner surfaces bound.
#pragma once

#include <vector>

#include "isoshell/advanced/lattice_surface.h"
#include "isoshell/advanced/site_set.h"

namespace isoshell {

/// One voxel in the hollow of each component whose normals point into it: the middle of the longest way from one of its
/// sites, along the axis nearest to the normal, to the next site. Components that look inward lie in others (see
/// boolean_union). Products in host memory. Cost: a few thousand ways a component.
std::vector<Voxel> find_hollows(const LatticeSurface& surface, const SiteSet& sites, const SiteSamples& samples);

}  // namespace isoshell
