// See around_edge.h.
#include "measure/around_edge.h"

#include <algorithm>
#include <cstddef>

#include "measure/exact_signs.h"

namespace isoshell {
namespace {

/// Of three points of a plane that has an area on one of the planes of two axes: 1 or -1, 0 where it has none.
int turn_in(int axis, const WorldPoint& a, const WorldPoint& b, const WorldPoint& c) {
  const auto seen = [axis](const WorldPoint& p) {
    return axis == 0 ? WorldPoint2{p.y, p.z} : axis == 1 ? WorldPoint2{p.z, p.x} : WorldPoint2{p.x, p.y};
  };
  return turn(seen(a), seen(b), seen(c));
}

/// Whether two points of a plane through a line lie on one side of it.
bool are_on_one_side(const WorldPoint& a, const WorldPoint& b, const WorldPoint& p, const WorldPoint& q) {
  for (int axis = 0; axis < 3; ++axis)
    if (const int side = turn_in(axis, a, b, p)) return turn_in(axis, a, b, q) == side;
  return true;
}

}  // namespace

std::vector<TriangleAtEdge> triangles_at_edge(const std::vector<std::array<uint32_t, 3>>& triangles, uint32_t from,
                                              View<const EdgeSide> sides) {
  std::vector<TriangleAtEdge> around;
  around.reserve(size_t(sides.size));
  for (const EdgeSide& s : sides) {
    const uint32_t triangle = s.half_edge / 3, i = s.half_edge % 3;
    const auto& corner = triangles[triangle];
    around.push_back({triangle, corner[(i + 2) % 3], corner[i] == from});
  }
  return around;
}

void leave_out_flat(const std::vector<WorldPoint>& points, uint32_t from, uint32_t to,
                    std::vector<TriangleAtEdge>& triangles) {
  const auto is_flat = [&](const TriangleAtEdge& t) {
    for (int axis = 0; axis < 3; ++axis)
      if (turn_in(axis, points[from], points[to], points[t.apex]) != 0) return false;
    return true;
  };
  triangles.erase(std::remove_if(triangles.begin(), triangles.end(), is_flat), triangles.end());
}

void sort_around_edge(const std::vector<WorldPoint>& points, uint32_t from, uint32_t to,
                      std::vector<TriangleAtEdge>& triangles) {
  const WorldPoint &a = points[from], &b = points[to], &first = points[triangles.front().apex];
  struct Placed {
    TriangleAtEdge at;
    int quarter;  // 0 where the first one is, 1 less than a half turn on, 2 opposite, 3 beyond
  };
  std::vector<Placed> placed;
  placed.reserve(triangles.size());
  for (const TriangleAtEdge& t : triangles) {
    const int side = side_of_plane(a, b, first, points[t.apex]);
    const bool is_with_first = side == 0 && are_on_one_side(a, b, first, points[t.apex]);
    placed.push_back({t, side > 0 ? 1 : side < 0 ? 3 : is_with_first ? 0 : 2});
  }
  std::sort(placed.begin(), placed.end(), [&](const Placed& p, const Placed& q) {
    if (p.quarter != q.quarter) return p.quarter < q.quarter;
    const int side = p.quarter % 2 == 0 ? 0 : side_of_plane(a, b, points[p.at.apex], points[q.at.apex]);
    if (side != 0) return side > 0;
    return p.at.rises != q.at.rises ? p.at.rises : p.at.triangle < q.at.triangle;
  });
  for (size_t i = 0; i < placed.size(); ++i) triangles[i] = placed[i].at;
}

}  // namespace isoshell
