// The edges of curves of a mesh, to be looked up.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "features/mesh/curve_paths.h"

namespace isoshell {

/// Keys of edges, and the paths that they are on; ascending.
using CurveEdges = std::vector<std::pair<uint64_t, uint32_t>>;

/// Of a mesh in which each vertex of the paths has become another one, or none: kNone. Cost: a sort of the edges.
CurveEdges curve_edges(const std::vector<CurvePath>& paths, const std::vector<uint32_t>& becomes);
/// kNone for an edge that is on none.
uint32_t curve_of(const CurveEdges& edges, uint32_t u, uint32_t v);

}  // namespace isoshell
