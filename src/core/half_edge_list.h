// The half-edges of any triangles, by their edges.
#pragma once

#include <array>
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

/// All of them, by edge and then by number. There are at most UINT32_MAX / 3 triangles.
std::vector<ListedHalfEdge> sorted_half_edges(const std::vector<std::array<uint32_t, 3>>& triangles);

}  // namespace isoshell
