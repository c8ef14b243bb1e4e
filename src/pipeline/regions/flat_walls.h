// Flat walls that stay flat.
#pragma once

#include "features/cutting/cut_surface.h"
#include "isoshell/triangle_mesh.h"
#include "pipeline/regions/region_walls.h"

namespace isoshell {

/// Moves vertices of flat patches back onto their planes, which the lattice moved them off by its steps: those of two
/// onto the line that they share, those of three onto their point. `cut` is what the mesh was made of, and `walls` what
/// that was cut from. Cost: a look at all triangles of both.
void put_on_planes(const CutSurface& cut, const RegionWalls& walls, TriangleMesh& mesh);

}  // namespace isoshell
