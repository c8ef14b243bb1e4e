// The half-edges of any triangles, by their edges.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace isoshell {

/// An edge by its ends, the smaller one in the upper half.
inline uint64_t edge_key(uint32_t u, uint32_t v) { return u < v ? uint64_t(u) << 32 | v : uint64_t(v) << 32 | u; }

/// Half-edge 3 t + i runs from corner i of triangle t to the next one.
inline uint32_t next_in_triangle(uint32_t half_edge) { return half_edge % 3 == 2 ? half_edge - 2 : half_edge + 1; }

struct ListedHalfEdge {
  uint64_t edge;  ///< edge_key
  uint32_t number;

  uint32_t smaller_end() const { return uint32_t(edge >> 32); }
  uint32_t larger_end() const { return uint32_t(edge); }
};

/// All of them, by edge and then by number. There are at most UINT32_MAX / 3 triangles. Cost: linear in triangles for
/// bounded valence, and in the largest index; 16 bytes a half-edge and 4 a vertex.
std::vector<ListedHalfEdge> sorted_half_edges(const std::vector<std::array<uint32_t, 3>>& triangles);

/// Calls visit(begin, end) with the range of each edge in such a list, in order.
template <class Visit>
void for_each_edge(const std::vector<ListedHalfEdge>& half_edges, Visit visit) {
  for (size_t begin = 0, end; begin < half_edges.size(); begin = end) {
    end = begin + 1;
    while (end < half_edges.size() && half_edges[end].edge == half_edges[begin].edge) ++end;
    visit(begin, end);
  }
}

}  // namespace isoshell
