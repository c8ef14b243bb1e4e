// Do two triangles meet outside of the corners that they share? Exact, in integers: of a lattice's PointQ8, or of any
// points whose differences and cross products are exact.
//
// Budget, coordinates of PointQ8 < 2^22: differences < 2^23, cross products < 2^47, and their products with a third
// difference < 2^72, the one 128-bit sum here.
#pragma once

#include "voxel/exact_int.h"

namespace isoshell {

/// Sign of the volume of (a, b, c, d): positive when d lies on the side that (b - a) x (c - a) points to.
template <class Point>
ISOSHELL_HD int side_of_plane(Point a, Point b, Point c, Point d) {
  const auto n = cross(difference(b, a), difference(c, a));
  const auto r = difference(d, a);
  const Int128 volume = Int128(n.x) * r.x + Int128(n.y) * r.y + Int128(n.z) * r.z;
  return (volume > 0) - (volume < 0);
}

/// A point of the plane in which a triangle is seen best: without the axis of the normal's largest component.
template <class Area>
struct Point2 {
  Area x, y;
};
template <class Point>
ISOSHELL_HD auto seen_along(Point p, int axis) {
  using Seen = Point2<decltype(cross(difference(p, p), difference(p, p)).x)>;
  return axis == 0 ? Seen{p.y, p.z} : (axis == 1 ? Seen{p.z, p.x} : Seen{p.x, p.y});
}
template <class Area>
ISOSHELL_HD int turn(Point2<Area> a, Point2<Area> b, Point2<Area> c) {
  const Area area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  return (area > 0) - (area < 0);
}
/// c lies on the line through a and b: is it on the closed segment?
template <class Area>
ISOSHELL_HD bool within_segment(Point2<Area> a, Point2<Area> b, Point2<Area> c) {
  return (c.x - a.x) * (c.x - b.x) <= 0 && (c.y - a.y) * (c.y - b.y) <= 0;
}
template <class Area>
ISOSHELL_HD bool segments_meet(Point2<Area> a, Point2<Area> b, Point2<Area> c, Point2<Area> d) {
  const int s = turn(a, b, c), t = turn(a, b, d), u = turn(c, d, a), v = turn(c, d, b);
  if (s * t < 0 && u * v < 0) return true;
  return (s == 0 && within_segment(a, b, c)) || (t == 0 && within_segment(a, b, d)) ||
         (u == 0 && within_segment(c, d, a)) || (v == 0 && within_segment(c, d, b));
}
template <class Area>
ISOSHELL_HD bool triangle_holds(Point2<Area> a, Point2<Area> b, Point2<Area> c, Point2<Area> p) {
  const int s = turn(a, b, p), t = turn(b, c, p), u = turn(c, a, p);
  return (s >= 0 && t >= 0 && u >= 0) || (s <= 0 && t <= 0 && u <= 0);
}

/// Axis of the largest component of a triangle's normal; -1 for a triangle without area.
template <class Point>
ISOSHELL_HD int best_axis(Point a, Point b, Point c) {
  const auto n = cross(difference(b, a), difference(c, a));
  const auto x = n.x < 0 ? -n.x : n.x, y = n.y < 0 ? -n.y : n.y, z = n.z < 0 ? -n.z : n.z;
  if (x == 0 && y == 0 && z == 0) return -1;
  return x >= y && x >= z ? 0 : (y >= z ? 1 : 2);
}

template <class Point>
ISOSHELL_HD bool boxes_of_segments_meet(Point p, Point q, Point a, Point b) {
  const auto apart = [](auto s, auto t, auto u, auto v) {
    return (s < u && s < v && t < u && t < v) || (s > u && s > v && t > u && t > v);
  };
  return !apart(p.x, q.x, a.x, b.x) && !apart(p.y, q.y, a.y, b.y) && !apart(p.z, q.z, a.z, b.z);
}
/// Closed segments, each of which may be a point.
template <class Point>
ISOSHELL_HD bool segments_meet_in_space(Point p, Point q, Point a, Point b) {
  if (side_of_plane(p, q, a, b) != 0) return false;
  int axis = best_axis(p, q, a);
  if (axis < 0) axis = best_axis(p, q, b);
  if (axis < 0) axis = best_axis(a, b, p);
  if (axis < 0) return boxes_of_segments_meet(p, q, a, b);  // all on one line
  return segments_meet(seen_along(p, axis), seen_along(q, axis), seen_along(a, axis), seen_along(b, axis));
}

/// Closed segment pq, which may be a point, against closed triangle abc.
template <class Point>
ISOSHELL_HD bool segment_meets_triangle(Point p, Point q, Point a, Point b, Point c) {
  const int side_p = side_of_plane(a, b, c, p), side_q = side_of_plane(a, b, c, q);
  if (side_p * side_q > 0) return false;
  if (side_p == 0 && side_q == 0) {
    const int axis = best_axis(a, b, c);
    if (axis < 0)
      return segments_meet_in_space(p, q, a, b) || segments_meet_in_space(p, q, b, c) ||
             segments_meet_in_space(p, q, c, a);
    const auto p2 = seen_along(p, axis), q2 = seen_along(q, axis), a2 = seen_along(a, axis), b2 = seen_along(b, axis),
               c2 = seen_along(c, axis);
    return triangle_holds(a2, b2, c2, p2) || segments_meet(p2, q2, a2, b2) || segments_meet(p2, q2, b2, c2) ||
           segments_meet(p2, q2, c2, a2);
  }
  const int s = side_of_plane(p, q, a, b), t = side_of_plane(p, q, b, c), u = side_of_plane(p, q, c, a);
  return (s >= 0 && t >= 0 && u >= 0) || (s <= 0 && t <= 0 && u <= 0);
}

/// A triangle by the ids and the places of its corners.
template <class Point>
struct CornersAt {
  uint32_t id[3];
  Point at[3];
};
using CornersOfTriangle = CornersAt<PointQ8>;

/// Two different closed triangles: do they meet outside of what they share? Corners are shared by id: another one at
/// the same place counts. A triangle without area is the segment, or the point, that its corners span. False for three
/// shared corners.
template <class Point>
ISOSHELL_HD bool triangles_intersect(const CornersAt<Point>& s, const CornersAt<Point>& t) {
  int shared = 0, own_s = 0, own_t = 0, corner_s = 0, corner_t = 0;  // the sums of the places give the place left over
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (s.id[i] == t.id[j]) ++shared, own_s += i, own_t += j, corner_s = i, corner_t = j;
  if (shared == 3) return false;
  if (shared == 2) {
    // Around a common edge they overlap only when one is folded onto the other.
    const int c = 3 - own_s, d = 3 - own_t;
    const Point a = s.at[(c + 1) % 3], b = s.at[(c + 2) % 3];
    if (side_of_plane(a, b, s.at[c], t.at[d]) != 0) return false;
    const int axis = best_axis(a, b, s.at[c]);
    if (axis < 0 || best_axis(a, b, t.at[d]) < 0)  // what sticks out of the edge is a corner, or ends at one
      return segment_meets_triangle(s.at[c], s.at[c], t.at[0], t.at[1], t.at[2]) ||
             segment_meets_triangle(t.at[d], t.at[d], s.at[0], s.at[1], s.at[2]);
    const auto a2 = seen_along(a, axis), b2 = seen_along(b, axis);
    return turn(a2, b2, seen_along(s.at[c], axis)) == turn(a2, b2, seen_along(t.at[d], axis));
  }
  if (shared == 1) {
    // What they have in common starts at the corner and ends at a side opposite of it.
    const int i = corner_s, j = corner_t;
    return segment_meets_triangle(s.at[(i + 1) % 3], s.at[(i + 2) % 3], t.at[0], t.at[1], t.at[2]) ||
           segment_meets_triangle(t.at[(j + 1) % 3], t.at[(j + 2) % 3], s.at[0], s.at[1], s.at[2]);
  }
  for (int i = 0; i < 3; ++i)
    if (segment_meets_triangle(s.at[i], s.at[(i + 1) % 3], t.at[0], t.at[1], t.at[2]) ||
        segment_meets_triangle(t.at[i], t.at[(i + 1) % 3], s.at[0], s.at[1], s.at[2]))
      return true;
  return false;
}

/// Whether the corners of a triangle that are not another one's lie on one side of that one's plane, and not in it:
/// they meet in shared corners at most. Most neighbours in a mesh do.
template <class Point>
bool is_beside_plane(const CornersAt<Point>& t, const CornersAt<Point>& of) {
  const auto normal = cross(difference(of.at[1], of.at[0]), difference(of.at[2], of.at[0]));
  int low = 1, high = -1;
  for (int j = 0; j < 3; ++j) {
    const uint32_t id = t.id[j];
    if (id == of.id[0] || id == of.id[1] || id == of.id[2]) continue;
    const auto r = difference(t.at[j], of.at[0]);
    const Int128 volume = Int128(normal.x) * r.x + Int128(normal.y) * r.y + Int128(normal.z) * r.z;
    const int side = (volume > 0) - (volume < 0);
    low = side < low ? side : low;
    high = side > high ? side : high;
  }
  return low == high && low != 0;
}

/// Whether triangles share one corner, and the side opposite of it of neither reaches the box of the other: they meet
/// there only. Most of those of a fan do that have many between them.
template <class Point>
bool are_apart_but_for_corner(const CornersAt<Point>& s, const CornersAt<Point>& t) {
  int shared = 0, corner_s = 0, corner_t = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (s.id[i] == t.id[j]) ++shared, corner_s = i, corner_t = j;
  if (shared != 1) return false;
  const auto is_off = [](const CornersAt<Point>& of, int corner, const CornersAt<Point>& other) {
    const Point &a = of.at[(corner + 1) % 3], &b = of.at[(corner + 2) % 3];
    const auto on_axis = [](auto p, auto q, auto c, auto d, auto e) {
      return (p < c && p < d && p < e && q < c && q < d && q < e) ||
             (p > c && p > d && p > e && q > c && q > d && q > e);
    };
    return on_axis(a.x, b.x, other.at[0].x, other.at[1].x, other.at[2].x) ||
           on_axis(a.y, b.y, other.at[0].y, other.at[1].y, other.at[2].y) ||
           on_axis(a.z, b.z, other.at[0].z, other.at[1].z, other.at[2].z);
  };
  return is_off(s, corner_s, t) && is_off(t, corner_t, s);
}

/// As triangles_intersect, sooner where most triangles lie beside each other, as neighbours do.
template <class Point>
bool triangles_intersect_apart(const CornersAt<Point>& s, const CornersAt<Point>& t) {
  return !are_apart_but_for_corner(s, t) && !is_beside_plane(t, s) && !is_beside_plane(s, t) &&
         triangles_intersect(s, t);
}

}  // namespace isoshell
