// Corners of curves at opposite sides of a periodic volume.
#pragma once

#include "features/mesh/feature_mesh.h"
#include "isoshell/advanced/lattice.h"

namespace isoshell {

/// Where a curve at one side has a corner, the one opposite has one, too. `period_world`: as in FaceRegions. Vertices
/// are opposite to each other that are so on the lattice of `frame`. Parts of a curve follow each other. Cost: a sort
/// of the vertices of curves.
void tie_corners(const FeatureMesh& mesh, const LatticeFrame& frame, const WorldPoint& period_world,
                 CurveNetwork& network);

}  // namespace isoshell
