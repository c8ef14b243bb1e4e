// Triangles between points and lines of a plane.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace isoshell {

/// Coordinates from 0 to kLargestInPlane.
struct PlanePoint {
  int64_t x, y;
};
constexpr int64_t kLargestInPlane = int64_t(1) << 40;

/// Fills what is inside of the closed lines among `lines` with triangles that turn to the left. Every line between two
/// points is an edge of them; other edges are Delaunay. Decided exactly. None where two points are one, lines cross, or
/// a point lies on a line. Of `wishes` those are edges as well that cross no line and no earlier one of them. Cost:
/// n sqrt n in the number of points.
std::optional<std::vector<std::array<uint32_t, 3>>> triangulate_plane(
    const std::vector<PlanePoint>& points, const std::vector<std::array<uint32_t, 2>>& lines,
    const std::vector<std::array<uint32_t, 2>>& wishes = {});

/// Of triangles that fill closed lines, which may lie in one another, those to the left of the lines. Cost: a sort of
/// their edges.
std::vector<std::array<uint32_t, 3>> left_of(const std::vector<std::array<uint32_t, 2>>& lines,
                                             const std::vector<std::array<uint32_t, 3>>& triangles);

}  // namespace isoshell
