// Creases of the frame before, which those of this one are compared with.
#pragma once

#include <vector>

#include "features/curves/edge_chains.h"
#include "geometry/point_cells.h"
#include "isoshell/previous_frame.h"

namespace isoshell {

/// The edges of the frame before whose triangles turn by 40 degrees or more, where its vertices have gone to: creases,
/// and places that are sharp without one. Cost: a sort of the edges.
class CreasesBefore {
 public:
  CreasesBefore(const PreviousFrame& previous, double edge_length_world);
  /// Whether half of a chain or more runs along them, half an edge's length away at most. Cost: a search for each of
  /// its edges.
  bool hold(const FeatureMesh& mesh, const EdgeChain& chain) const;

 private:
  bool are_near(const WorldPoint& place) const;

  double reach_world_;
  std::vector<WorldPoint> places_;  ///< on the creases, no farther apart than the reach
  PointCells cells_;
};

}  // namespace isoshell
