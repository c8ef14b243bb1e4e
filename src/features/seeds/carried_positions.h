// Where vertices of the frame before lie on the paths of this one.
#pragma once

#include "features/mesh/refine_mesh.h"

namespace isoshell {

struct PositionOnPath {
  static constexpr size_t kNoPath = ~size_t(0);
  size_t path = kNoPath;
  PathPoint at;  ///< beyond the last edge at the end of an open path
};

/// Per point the path that it lies on: the nearest one, less than a tenth of an edge's length away, which vertices
/// beside a curve are not. Cost: a sort of the points, and a look at those around every edge of a path.
std::vector<PositionOnPath> positions_on_paths(const FineMesh& mesh, const std::vector<WorldPoint>& points);

}  // namespace isoshell
