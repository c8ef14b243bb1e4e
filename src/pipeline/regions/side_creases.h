// Where walls of voxels leave the sides of their volume.
#pragma once

#include "features/mesh/feature_mesh.h"
#include "isoshell/regions.h"

namespace isoshell {

/// The edges at which walls leave a side of the volume, or go from one to another; each smaller end first, ascending.
/// Without those around parts of sides that are narrower than two edges of the result, which have no room for a row of
/// vertices: what a volume cuts off of a thin layer; of a periodic volume all are there. Cost: linear in the triangles
/// there, and in vertices.
EdgeList side_creases(const FeatureMesh& walls, const FaceRegions& regions, double edge_length_world);

}  // namespace isoshell
