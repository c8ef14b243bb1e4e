// Boxes along the axes, around points of the world or of the lattice.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "isoshell/advanced/lattice.h"

namespace isoshell {

using BoxQ8 = BoxOf<PointQ8>;

template <class Point>
Point smallest_of(const Point& a, const Point& b) {
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
template <class Point>
Point largest_of(const Point& a, const Point& b) {
  return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}

/// Around both.
template <class Point>
BoxOf<Point> joined(const BoxOf<Point>& a, const BoxOf<Point>& b) {
  return {smallest_of(a.min, b.min), largest_of(a.max, b.max)};
}
template <class Point>
void stretch(BoxOf<Point>& box, const Point& to) {
  box = joined(box, {to, to});
}
/// Whether they have a point in common.
template <class Point>
bool boxes_meet(const BoxOf<Point>& a, const BoxOf<Point>& b) {
  return a.min.x <= b.max.x && b.min.x <= a.max.x && a.min.y <= b.max.y && b.min.y <= a.max.y && a.min.z <= b.max.z &&
         b.min.z <= a.max.z;
}

/// By so much on each side.
template <class Point, class Distance>
BoxOf<Point> widened(const BoxOf<Point>& box, Distance by) {
  return {{box.min.x - by, box.min.y - by, box.min.z - by}, {box.max.x + by, box.max.y + by, box.max.z + by}};
}

template <class Point>
BoxOf<Point> box_of(const Point& a, const Point& b) {
  return {smallest_of(a, b), largest_of(a, b)};
}
/// Of a triangle.
template <class Point>
BoxOf<Point> box_of(const Point& a, const Point& b, const Point& c) {
  return joined(box_of(a, b), {c, c});
}

/// Around no point: what is stretched to points is the box of these.
inline WorldBox box_of_none() {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  return {{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}};
}
inline WorldBox box_of(const std::vector<WorldPoint>& points) {
  WorldBox box = box_of_none();
  for (const WorldPoint& p : points) stretch(box, p);
  return box;
}
/// Of the points that are corners.
inline WorldBox box_of(const std::vector<WorldPoint>& points, const std::vector<std::array<uint32_t, 3>>& triangles) {
  WorldBox box = box_of_none();
  for (const auto& t : triangles)
    for (const uint32_t v : t) stretch(box, points[v]);
  return box;
}

inline double longest_side(const WorldBox& box) {
  return std::max({box.max.x - box.min.x, box.max.y - box.min.y, box.max.z - box.min.z});
}

}  // namespace isoshell
