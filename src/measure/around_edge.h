// Triangles around an edge that they share, in the order of their angles, exactly.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "geometry/half_edges.h"
#include "isoshell/advanced/lattice.h"

namespace isoshell {

/// A triangle that has an edge, seen along it from its first end.
struct TriangleAtEdge {
  uint32_t triangle;
  uint32_t apex;  ///< the corner that is no end of the edge
  bool rises;     ///< passes the edge from its first end to the second, so that it faces to larger angles
};

/// Those with the edge, as it is seen from its end `from`.
std::vector<TriangleAtEdge> triangles_at_edge(const std::vector<std::array<uint32_t, 3>>& triangles, uint32_t from,
                                              View<const EdgeSide> sides);

/// Leaves out those whose three corners lie on a line, which are at no angle. Decides without error.
void leave_out_flat(const std::vector<WorldPoint>& points, uint32_t from, uint32_t to,
                    std::vector<TriangleAtEdge>& triangles);

/// Counter-clockwise about the edge, from the apex of the first one on. Of triangles that lie on one another those that
/// face to larger angles come first: backs of solids that touch then look away from each other. Decides by signs of
/// determinants without error. There is a triangle, the ends of the edge differ, and no apex lies on its line, see
/// leave_out_flat(). Cost: a sort.
void sort_around_edge(const std::vector<WorldPoint>& points, uint32_t from, uint32_t to,
                      std::vector<TriangleAtEdge>& triangles);

}  // namespace isoshell
