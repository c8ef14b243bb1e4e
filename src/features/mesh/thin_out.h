// Walls between regions with fewer triangles, where voxels made far more than a result needs.
#pragma once

#include "features/mesh/feature_mesh.h"
#include "isoshell/backend.h"

namespace isoshell {

struct KeptInWalls {
  EdgeList creases = {};                ///< by their ends, smaller ones first, and ascending
  std::vector<uint32_t> vertices = {};  ///< that stay
};

/// Takes vertices into their neighbours, on curves along these, until edges are about a third of `edge_world`. Curves
/// are also along the creases that are given. Corners stay, the
/// topology stays, no triangle turns over, and none comes to meet another one on the lattice of `frame`; patches
/// between curves with fewer vertices inside than `fewest` stay as they are. A vertex that stays is where it was, and a
/// triangle that stays keeps its source face. Result: the same for any number of threads. Cost: O(mesh), some ten
/// microseconds a vertex that goes; 80 bytes a vertex beside the mesh. Throws: interrupted.
FeatureMesh thin_out(FeatureMesh mesh, const KeptInWalls& kept, const LatticeFrame& frame, double edge_world,
                     uint32_t fewest, const Context& context);

}  // namespace isoshell
