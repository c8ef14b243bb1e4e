// Creases of the frame before, which those of this one are compared with.
#pragma once

#include <array>
#include <vector>

#include "core/point_cells.h"
#include "features/edge_chains.h"

namespace isoshell {

/// The sharp edges of a mesh, where its vertices have gone to. Cost: a sort of the edges.
class CreasesBefore {
 public:
  /// Edges whose triangles turn by 40 degrees or more in `vertices`. `reach_world`: how far beside them they hold.
  CreasesBefore(const std::vector<WorldPoint>& vertices, const std::vector<std::array<uint32_t, 3>>& triangles,
                const std::vector<WorldPoint>& carried, double reach_world);
  /// Whether half of a chain or more runs along them. Cost: a search for each of its edges.
  bool hold(const FeatureMesh& mesh, const EdgeChain& chain) const;

 private:
  bool are_near(const WorldPoint& place) const;

  double reach_world_;
  std::vector<WorldPoint> places_;  ///< on the edges, no farther apart than the reach
  PointCells cells_;
};

}  // namespace isoshell
