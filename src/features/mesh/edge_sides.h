// The half-edges of a mesh by edge.
#pragma once

#include "core/buckets.h"
#include "features/mesh/mesh_fans.h"

namespace isoshell {

/// Half-edge 3 t + i, which runs from corner i of triangle t to the next one, as a side of its edge.
struct EdgeSide {
  uint32_t larger_end;
  uint32_t half_edge;

  bool operator<(const EdgeSide& o) const {
    return larger_end != o.larger_end ? larger_end < o.larger_end : half_edge < o.half_edge;
  }
};

/// By the smaller ends of their edges, then ascending.
using EdgeSides = Buckets<EdgeSide>;

inline EdgeSides find_edge_sides(const MeshTriangles& triangles, size_t vertices) {
  return sort_into_buckets<EdgeSide>(int64_t(vertices), int64_t(triangles.size()), [&](int64_t t, auto put) {
    const auto& c = triangles[size_t(t)];
    for (size_t i = 0; i < 3; ++i) {
      const uint32_t u = c[i], v = c[(i + 1) % 3];
      put(std::min(u, v), EdgeSide{std::max(u, v), uint32_t(3 * size_t(t) + i)});
    }
  });
}

/// Calls visit(larger end, sides) for each of the edges whose smaller end a vertex is.
template <class Visit>
void for_each_edge_from(const EdgeSides& sides, int64_t vertex, Visit visit) {
  const View<const EdgeSide> in = sides.in(vertex);
  for (int64_t begin = 0, end = 0; begin < in.size; begin = end) {
    while (end < in.size && in[end].larger_end == in[begin].larger_end) ++end;
    visit(in[begin].larger_end, in.part(begin, end - begin));
  }
}

/// Between the edges `cut_edges`: their keys, ascending.
MeshTwins find_twins(const MeshTriangles& triangles, const EdgeSides& sides, const std::vector<uint64_t>& cut_edges);

}  // namespace isoshell
