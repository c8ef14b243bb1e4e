// A mesh cut open along edges: what is left around every vertex, and what hangs together.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "geometry/half_edges.h"

namespace isoshell {

using MeshTriangles = std::vector<std::array<uint32_t, 3>>;

/// Corner 3 t + i is corner i of triangle t. Half-edge 3 t + i runs from there to the next corner.
struct MeshFans {
  std::vector<uint32_t> of_corner;  ///< fan of every corner: those of a vertex between edges that are cut
  std::vector<uint32_t> vertex;     ///< per fan its vertex
  std::vector<uint32_t> patch;      ///< per triangle its component over edges that are not cut
  std::vector<uint32_t> cut;        ///< the half-edges of edges that are cut, ascending
  uint32_t patch_count = 0;
};

/// How a mesh hangs together between edges that are cut.
struct MeshTwins {
  std::vector<uint32_t> of;  ///< per half-edge the other one of its edge, where that is not cut and has two triangles,
                             ///< which pass it in opposite directions; kNone elsewhere
  std::vector<uint32_t> part;  ///< per triangle the first one of its component
};

/// Between the edges `cut_edges`: their keys, ascending.
MeshTwins find_twins(const MeshTriangles& triangles, const EdgeSides& sides, const std::vector<uint64_t>& cut_edges);

/// Fans are numbered by their first corner, patches by their first triangle. `cut_edges`: keys, ascending. Cost: a sort
/// of the half-edges. Throws: usage where an edge that is not cut has not two triangles that pass it in opposite
/// directions, or an edge that is cut has none.
MeshFans find_fans(const MeshTriangles& triangles, int64_t vertices, const std::vector<uint64_t>& cut_edges);

/// The same where it is known how the mesh hangs together.
MeshFans find_fans(const MeshTriangles& triangles, int64_t vertices, const std::vector<uint64_t>& cut_edges,
                   MeshTwins twins);

}  // namespace isoshell
