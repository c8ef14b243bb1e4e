// The half-edges of any triangles, by their edges.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/buckets.h"
#include "isoshell/error.h"

namespace isoshell {

/// An edge by its ends, the smaller one in the upper half.
inline uint64_t edge_key(uint32_t u, uint32_t v) { return u < v ? uint64_t(u) << 32 | v : uint64_t(v) << 32 | u; }

/// Half-edge 3 t + i runs from corner i of triangle t to the next one.
inline uint32_t next_in_triangle(uint32_t half_edge) { return half_edge % 3 == 2 ? half_edge - 2 : half_edge + 1; }

/// A half-edge as a side of its edge.
struct EdgeSide {
  uint32_t larger_end;
  uint32_t half_edge;

  bool operator<(const EdgeSide& o) const {
    return larger_end != o.larger_end ? larger_end < o.larger_end : half_edge < o.half_edge;
  }
};

/// By the smaller ends of their edges, then ascending.
using EdgeSides = Buckets<EdgeSide, uint32_t>;

/// Cost: linear in triangles for bounded valence, and in vertices; 8 bytes a half-edge and 4 a vertex. Throws:
/// out_of_memory for more than UINT32_MAX / 3 triangles, whose half-edges have no numbers.
inline EdgeSides find_edge_sides(const std::vector<std::array<uint32_t, 3>>& triangles, size_t vertices) {
  constexpr size_t kMost = std::numeric_limits<uint32_t>::max() / 3;
  if (triangles.size() > kMost)
    throw Error(
        ErrorCode::out_of_memory, "edges",
        std::to_string(triangles.size()) + " triangles; their edges can be listed of at most " + std::to_string(kMost));
  return sort_into_buckets<EdgeSide, uint32_t>(int64_t(vertices), int64_t(triangles.size()), [&](int64_t t, auto put) {
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
/// Calls visit(smaller end, larger end, sides) for all edges, in the order of their keys.
template <class Visit>
void for_each_edge(const EdgeSides& sides, Visit visit) {
  for (uint32_t u = 0; u < sides.count(); ++u)
    for_each_edge_from(sides, u, [&](uint32_t v, View<const EdgeSide> on_edge) { visit(u, v, on_edge); });
}

}  // namespace isoshell
