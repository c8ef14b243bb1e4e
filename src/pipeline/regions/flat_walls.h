// Flat walls that stay flat.
#pragma once

#include "features/cutting/cut_surface.h"
#include "isoshell/triangle_mesh.h"
#include "pipeline/regions/region_walls.h"

namespace isoshell {

/// Moves vertices of flat patches back onto their planes, which the lattice moved them off by its steps: those of two
/// onto the line that they share, those of three onto their point, and corners where they were as the walls came in.
/// Those of triangles that would turn by 60 degrees or meet others then stay. `cut` is what the mesh was made of,
/// `walls` what that was cut from, and `home` as of JoinedPatches. Throws: interrupted. Cost: a look at all triangles
/// of both, and a search for those that meet, again where some do.
void put_on_planes(const CutSurface& cut, const RegionWalls& walls, View<const uint32_t> home, TriangleMesh& mesh,
                   Context& context);

}  // namespace isoshell
