// Self-intersections: pairs of boxes from a tree, and exact tests of their triangles.
#include "measure/self_intersections.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <memory>
#include <numeric>

#include "core/parallel_ranges.h"
#include "core/watched.h"
#include "geometry/triangle_list.h"
#include "geometry/world_vector.h"
#include "measure/box_tree.h"
#include "measure/exact_signs.h"

namespace isoshell {
namespace {

constexpr size_t kChunk = 1024;
constexpr double kBoxSteps = 1 << 30;  ///< of the longest side of all boxes

using Points = std::array<WorldPoint, 3>;

WorldPoint2 seen_along(const WorldPoint& p, int axis) {
  return axis == 0 ? WorldPoint2{p.y, p.z} : axis == 1 ? WorldPoint2{p.z, p.x} : WorldPoint2{p.x, p.y};
}

int turn_along(int axis, const WorldPoint& a, const WorldPoint& b, const WorldPoint& c) {
  return turn(seen_along(a, axis), seen_along(b, axis), seen_along(c, axis));
}

/// An axis along which the triangle is seen with area, the best one if rounding allows; -1 where there is none.
int seeing_axis(const Points& t) {
  const WorldPoint n = doubled_area(t[0], t[1], t[2]);
  const double size[3] = {std::abs(n.x), std::abs(n.y), std::abs(n.z)};
  const int best = size[0] >= size[1] && size[0] >= size[2] ? 0 : size[1] >= size[2] ? 1 : 2;
  for (const int axis : {best, (best + 1) % 3, (best + 2) % 3})
    if (turn_along(axis, t[0], t[1], t[2]) != 0) return axis;
  return -1;
}

bool all_one_way(int s, int t, int u) { return (s >= 0 && t >= 0 && u >= 0) || (s <= 0 && t <= 0 && u <= 0); }
bool strictly_one_side(const std::array<int, 3>& s) {
  return (s[0] > 0 && s[1] > 0 && s[2] > 0) || (s[0] < 0 && s[1] < 0 && s[2] < 0);
}

/// c lies on the line through a and b.
bool within_segment(const WorldPoint2& a, const WorldPoint2& b, const WorldPoint2& c) {
  return std::min(a.x, b.x) <= c.x && c.x <= std::max(a.x, b.x) && std::min(a.y, b.y) <= c.y &&
         c.y <= std::max(a.y, b.y);
}

bool segments_meet(const WorldPoint2& a, const WorldPoint2& b, const WorldPoint2& c, const WorldPoint2& d) {
  const int s = turn(a, b, c), t = turn(a, b, d), u = turn(c, d, a), v = turn(c, d, b);
  if (s * t < 0 && u * v < 0) return true;
  return (s == 0 && within_segment(a, b, c)) || (t == 0 && within_segment(a, b, d)) ||
         (u == 0 && within_segment(c, d, a)) || (v == 0 && within_segment(c, d, b));
}

bool segment_meets_in_plane(const WorldPoint& p, const WorldPoint& q, const Points& t) {
  const int axis = seeing_axis(t);
  const WorldPoint2 from = seen_along(p, axis), to = seen_along(q, axis);
  const WorldPoint2 a = seen_along(t[0], axis), b = seen_along(t[1], axis), c = seen_along(t[2], axis);
  const auto holds = [&](const WorldPoint2& at) { return all_one_way(turn(a, b, at), turn(b, c, at), turn(c, a, at)); };
  return holds(from) || holds(to) || segments_meet(from, to, a, b) || segments_meet(from, to, b, c) ||
         segments_meet(from, to, c, a);
}

/// A segment against a closed triangle; on which sides of its plane the ends lie is known.
bool segment_meets(const WorldPoint& p, const WorldPoint& q, int side_p, int side_q, const Points& t) {
  if (side_p * side_q > 0) return false;
  if (side_p == 0 && side_q == 0) return segment_meets_in_plane(p, q, t);
  return all_one_way(side_of_plane(p, q, t[0], t[1]), side_of_plane(p, q, t[1], t[2]), side_of_plane(p, q, t[2], t[0]));
}

std::array<int, 3> sides(const Points& plane, const Points& of) {
  std::array<int, 3> side{};
  for (size_t i = 0; i < 3; ++i) side[i] = side_of_plane(plane[0], plane[1], plane[2], of[i]);
  return side;
}

bool apart_triangles_meet(const Points& a, const Points& b) {
  const std::array<int, 3> of_b = sides(a, b);
  if (strictly_one_side(of_b)) return false;
  const std::array<int, 3> of_a = sides(b, a);
  if (strictly_one_side(of_a)) return false;
  for (size_t i = 0; i < 3; ++i) {
    const size_t j = (i + 1) % 3;
    if (segment_meets(b[i], b[j], of_b[i], of_b[j], a) || segment_meets(a[i], a[j], of_a[i], of_a[j], b)) return true;
  }
  return false;
}

/// They share a[i] and b[j]: what else they share, the side across from it of one of them meets.
bool meet_beyond_corner(const Points& a, size_t i, const Points& b, size_t j) {
  const WorldPoint &a1 = a[(i + 1) % 3], &a2 = a[(i + 2) % 3], &b1 = b[(j + 1) % 3], &b2 = b[(j + 2) % 3];
  const int of_b1 = side_of_plane(a[0], a[1], a[2], b1), of_b2 = side_of_plane(a[0], a[1], a[2], b2);
  if (of_b1 * of_b2 > 0) return false;
  const int of_a1 = side_of_plane(b[0], b[1], b[2], a1), of_a2 = side_of_plane(b[0], b[1], b[2], a2);
  if (of_a1 * of_a2 > 0) return false;
  return segment_meets(b1, b2, of_b1, of_b2, a) || segment_meets(a1, a2, of_a1, of_a2, b);
}

/// They share the edge of both that is across from a[i] and b[j]: only folded flat onto one another they meet beyond
/// it.
bool meet_beyond_edge(const Points& a, size_t i, const WorldPoint& across) {
  const WorldPoint &from = a[(i + 1) % 3], &to = a[(i + 2) % 3];
  if (side_of_plane(a[0], a[1], a[2], across) != 0) return false;
  const int axis = seeing_axis(a);
  return turn_along(axis, from, to, a[i]) == turn_along(axis, from, to, across);
}

struct Corners {
  std::array<uint32_t, 3> id;
  Points at;
};

bool triangles_meet(const Corners& a, const Corners& b) {
  size_t shared = 0, sum_a = 0, sum_b = 0;
  for (size_t i = 0; i < 3; ++i)
    for (size_t j = 0; j < 3; ++j)
      if (a.id[i] == b.id[j]) ++shared, sum_a += i, sum_b += j;
  if (shared == 0) return apart_triangles_meet(a.at, b.at);
  if (shared == 1) return meet_beyond_corner(a.at, sum_a, b.at, sum_b);
  return shared == 2 && meet_beyond_edge(a.at, 3 - sum_a, b.at[3 - sum_b]);
}

/// Boxes on a lattice that keeps their order along each axis: those that meet still do.
std::vector<BoxQ8> boxes_of(const TriangleMesh& mesh, const std::vector<uint32_t>& triangles) {
  WorldBox all = box_of_none();
  for (const uint32_t t : triangles)
    for (const uint32_t v : mesh.triangles[t]) stretch(all, mesh.vertices[v]);
  const WorldPoint &lo = all.min, &hi = all.max;
  const auto reach = [](double from, double to) { return to / 2 - from / 2; };  // whose difference may be no double
  const double side = std::max({reach(lo.x, hi.x), reach(lo.y, hi.y), reach(lo.z, hi.z)});
  const auto step = [&](double from, double x) { return int32_t(std::floor(reach(from, x) / side * kBoxSteps)); };
  const auto at = [&](uint32_t v) {
    const WorldPoint& p = mesh.vertices[v];
    return PointQ8{step(lo.x, p.x), step(lo.y, p.y), step(lo.z, p.z)};
  };
  std::vector<BoxQ8> boxes(triangles.size());
  for_each_index(size_t(0), triangles.size(), [&](size_t i) {
    const auto& [a, b, c] = mesh.triangles[triangles[i]];
    boxes[i] = box_of(at(a), at(b), at(c));
  });
  return boxes;
}

}  // namespace

std::vector<uint32_t> first_at_position(const std::vector<WorldPoint>& vertices) {
  std::vector<uint32_t> order, first(vertices.size());
  std::iota(first.begin(), first.end(), 0u);
  for (uint32_t v = 0; v < vertices.size(); ++v)
    if (is_finite(vertices[v])) order.push_back(v);
  tbb::parallel_sort(order.begin(), order.end(), [&](uint32_t i, uint32_t j) {
    const WorldPoint &p = vertices[i], &q = vertices[j];
    return p.x != q.x ? p.x < q.x : p.y != q.y ? p.y < q.y : p.z != q.z ? p.z < q.z : i < j;
  });
  for (size_t i = 1; i < order.size(); ++i) {
    const WorldPoint &p = vertices[order[i - 1]], &q = vertices[order[i]];
    if (p == q) first[order[i]] = first[order[i - 1]];
  }
  return first;
}

SelfIntersections find_self_intersections(const TriangleMesh& mesh, const std::vector<uint32_t>& first_at,
                                          Context& context) {
  require_indices(mesh.triangles, mesh.vertices.size(), "intersections");
  const auto corners = [&](uint32_t t) {
    const auto& [a, b, c] = mesh.triangles[t];
    return Corners{{first_at[a], first_at[b], first_at[c]}, {mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]}};
  };
  return run_with_threads(context, [&] {
    std::vector<uint8_t> flat(mesh.triangles.size());
    for_each_index(size_t(0), flat.size(), [&](size_t t) { flat[t] = seeing_axis(corners(uint32_t(t)).at) < 0; });
    std::vector<uint32_t> tested;
    for (uint32_t t = 0; t < flat.size(); ++t)
      if (!flat[t]) tested.push_back(t);
    if (tested.empty()) return SelfIntersections{};
    const std::vector<BoxQ8> boxes = boxes_of(mesh, tested);
    const BoxTree tree(boxes);
    std::unique_ptr<std::atomic<uint8_t>[]> meets(new std::atomic<uint8_t>[tested.size()]());
    std::vector<int64_t> pairs((tested.size() + kChunk - 1) / kChunk);
    for_each_index(size_t(0), pairs.size(), [&](size_t c) {
      for (size_t i = c * kChunk; i < std::min(tested.size(), (c + 1) * kChunk); ++i) {
        if (context.cancel.load(std::memory_order_relaxed)) return;
        const Corners here = corners(tested[i]);
        tree.for_all_meeting(boxes[i], [&](uint32_t other) {
          if (other > i && triangles_meet(here, corners(tested[other]))) {
            ++pairs[c];
            meets[i].store(1, std::memory_order_relaxed);
            meets[other].store(1, std::memory_order_relaxed);
          }
          return true;
        });
      }
    });
    check_cancel(context, "intersections");
    SelfIntersections found;
    for (const int64_t count : pairs) found.pairs += count;
    for (size_t i = 0; i < tested.size(); ++i)
      if (meets[i]) found.triangles.push_back(tested[i]);
    return found;
  });
}

}  // namespace isoshell
