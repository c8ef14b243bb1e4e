// Vectors of the world, for host and device.
#pragma once

#include <cmath>

#include "isoshell/advanced/host_device.h"
#include "isoshell/advanced/lattice.h"

namespace isoshell {

ISOSHELL_HD inline WorldPoint operator+(const WorldPoint& a, const WorldPoint& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
ISOSHELL_HD inline WorldPoint operator-(const WorldPoint& a, const WorldPoint& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
ISOSHELL_HD inline WorldPoint operator*(double by, const WorldPoint& a) { return {by * a.x, by * a.y, by * a.z}; }
ISOSHELL_HD inline double dot(const WorldPoint& a, const WorldPoint& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
ISOSHELL_HD inline double length_sq(const WorldPoint& a) { return dot(a, a); }
ISOSHELL_HD inline double length(const WorldPoint& a) { return std::sqrt(dot(a, a)); }
ISOSHELL_HD inline double distance_sq(const WorldPoint& a, const WorldPoint& b) { return length_sq(b - a); }
ISOSHELL_HD inline WorldPoint cross(const WorldPoint& a, const WorldPoint& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
ISOSHELL_HD inline bool operator==(const WorldPoint& a, const WorldPoint& b) {
  return a.x == b.x && a.y == b.y && a.z == b.z;
}
/// In an order that no numbering of points shows in.
ISOSHELL_HD inline bool is_before(const WorldPoint& a, const WorldPoint& b) {
  return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
}
/// Of length 1; 0 where a has no length, or one that is not finite.
inline WorldPoint normalised(const WorldPoint& a) {
  const double size = length(a);
  return size > 0 && std::isfinite(size) ? (1 / size) * a : WorldPoint{0, 0, 0};
}
/// Along the normal, as long as twice the triangle's area.
ISOSHELL_HD inline WorldPoint doubled_area(const WorldPoint& a, const WorldPoint& b, const WorldPoint& c) {
  return cross(b - a, c - a);
}
ISOSHELL_HD inline double triangle_area(const WorldPoint& a, const WorldPoint& b, const WorldPoint& c) {
  return length(doubled_area(a, b, c)) / 2;
}
/// The least of the heights of a triangle; 0 where its corners are one point.
ISOSHELL_HD inline double triangle_height(const WorldPoint& a, const WorldPoint& b, const WorldPoint& c) {
  const double longest = std::sqrt(std::fmax(std::fmax(distance_sq(a, b), distance_sq(b, c)), distance_sq(c, a)));
  return longest > 0 ? length(doubled_area(a, b, c)) / longest : 0;
}

}  // namespace isoshell
