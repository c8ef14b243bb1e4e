// What kind of complex any mesh is, edge by edge.
#pragma once

#include "isoshell/mesh_census.h"

namespace isoshell {

/// Parts of a census that come from its edges; the first of `mesh` without triangles that repeat a corner.
struct EdgeCensus {
  ComplexCounts counts;
  ValenceCounts valence;
  EdgeStatistics edges;
};
/// `middle`: of the bounding box, about which volumes are summed. `dropped` as for take_census.
EdgeCensus count_complex(const TriangleMesh& mesh, const WorldPoint& middle, int64_t dropped);

}  // namespace isoshell
