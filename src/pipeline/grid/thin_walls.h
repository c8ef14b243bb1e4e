// Walls that the edges of the result cannot follow on both sides are grown: what the sheet and its coarse proxies bound
// then.
#pragma once

#include "pipeline/grid/prepared_surface.h"

namespace isoshell {

constexpr int32_t kMostGrownVox = 9;  ///< closed by as much again it fits into the lattice's margin

/// How far walls without thickness grow to each side so that edges of this length turn around their rims: cells are as
/// wide as a rim then, and triangles across it as good as others.
int32_t growth_for_edge(double edge_vox);

/// Gives a prepared surface the sheet of all voxels within `grown_vox` of a site. Gaps up to twice its closing close,
/// or twice the growth if that is more; hollows too.
void grow_solid(PreparedSurface& prepared, int32_t grown_vox, int64_t smallest_component_q16, Context& context);

/// The voxels whose solid the sheet bounds, and by how much that is closed.
inline const SiteSet& solid_voxels_of(const PreparedSurface& p) { return p.grown ? p.grown.voxels : p.sites; }
inline int32_t closing_of_solid(const PreparedSurface& p) {
  if (p.grown.only_flaps) return p.closing_vox;
  return p.closing_vox > p.grown.distance_vox ? p.closing_vox - p.grown.distance_vox : 0;
}

}  // namespace isoshell
