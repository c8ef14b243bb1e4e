// Where a mesh of patches is no surface.
#pragma once

#include <vector>

#include "features/walls/wall_mesh.h"

namespace isoshell {

/// The vertices of a mesh around which the triangles between curves are not as many fans as the surface has there, that
/// have an edge off curves without two triangles of one patch that pass it in opposite directions, or an edge that is
/// on a curve and off it, or a triangle that is there twice; ascending. Cost: a sort of the edges, and of the
/// triangles.
std::vector<uint32_t> find_mesh_faults(const WallMesh& mesh);

}  // namespace isoshell
