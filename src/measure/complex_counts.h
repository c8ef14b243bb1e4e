// What kind of complex any mesh is, edge by edge.
#pragma once

#include <array>
#include <vector>

#include "core/index_sets.h"
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

/// `boundary`: half-edges of edges with one face; those that end in one fan of faces belong to one loop. `fans`: of
/// corners, as many as half-edges; a non-manifold edge ends a fan.
int64_t count_loops(IndexSets& fans, const std::vector<uint32_t>& boundary, int64_t half_edges);

/// Triangles with the corners of another one, in any order, beyond the first.
int64_t count_duplicates(std::vector<std::array<uint32_t, 3>> triangles);

}  // namespace isoshell
