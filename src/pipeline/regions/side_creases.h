// Where walls of voxels leave the sides of their volume.
#pragma once

#include <cstdint>
#include <vector>

#include "features/mesh/feature_mesh.h"

namespace isoshell {

/// The edges at which walls leave a side of the volume, or go from one to another; each smaller end first, ascending.
/// Without those around parts of sides that are narrower than two edges of the result, which have no room for a row of
/// vertices: what a volume cuts off of a thin layer. `side` is that of FaceRegions. Cost: linear in the triangles
/// there, and in vertices.
EdgeList side_creases(const FeatureMesh& walls, const std::vector<uint8_t>& side, double edge_length_world);

}  // namespace isoshell
