// Flat walls that stay flat.
#pragma once

#include "features/cutting/cut_surface.h"
#include "isoshell/triangle_mesh.h"
#include "pipeline/regions/region_walls.h"

namespace isoshell {

/// Moves vertices of flat patches back onto their planes, which the lattice moved them off by its steps: those of two
/// onto the line that they share, those of three onto their point, and corners where they were as the walls came in.
/// `cut` is what the mesh was made of, `walls` what that was cut from, and `home` as of JoinedPatches. Cost: a look at
/// all triangles of both.
void put_on_planes(const CutSurface& cut, const RegionWalls& walls, View<const uint32_t> home, TriangleMesh& mesh);

}  // namespace isoshell
