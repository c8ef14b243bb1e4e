// How good a triangle of the output is, and the vectors that the optimisation reckons with. Doubles follow integer
// positions by + - * / and sqrt in a fixed order.
#pragma once

#include "isoshell/advanced/lattice.h"
#include "voxel/closest_point.h"
#include "voxel/exact_int.h"

namespace isoshell::optimize {

/// A vector in q8, or a direction.
struct Vector {
  double x, y, z;
};
ISOSHELL_HD inline Vector operator+(Vector a, Vector b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
ISOSHELL_HD inline Vector operator-(Vector a, Vector b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
ISOSHELL_HD inline Vector operator*(double s, Vector a) { return {s * a.x, s * a.y, s * a.z}; }
ISOSHELL_HD inline double dot(Vector a, Vector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
ISOSHELL_HD inline Vector cross(Vector a, Vector b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
ISOSHELL_HD inline Vector from_to(PointQ8 a, PointQ8 b) {
  return {double(b.x - a.x), double(b.y - a.y), double(b.z - a.z)};
}
ISOSHELL_HD inline PointQ8 moved_by(PointQ8 p, Vector v) {
  return {p.x + int32_t(round_to_int(v.x)), p.y + int32_t(round_to_int(v.y)), p.z + int32_t(round_to_int(v.z))};
}
/// Unit vector; the zero vector stays.
ISOSHELL_HD inline Vector unit(Vector v) {
  const double length_sq = dot(v, v);
  return length_sq > 0 ? 1 / rounded_sqrt(length_sq) * v : v;
}
/// `v` shortened to at most `length`.
ISOSHELL_HD inline Vector at_most(Vector v, double length) {
  const double length_sq = dot(v, v);
  return length_sq > length * length ? length / rounded_sqrt(length_sq) * v : v;
}

/// Normal of a triangle, as long as twice its area. Doubles hold it exactly: corners differ by less than 2^24.
ISOSHELL_HD inline Vector normal_of(PointQ8 a, PointQ8 b, PointQ8 c) { return cross(from_to(a, b), from_to(a, c)); }
/// Angle below 45 degrees (cosine squared above one half).
ISOSHELL_HD inline bool within_45_degrees(Vector a, Vector b) {
  const double d = dot(a, b);
  return d > 0 && 2 * d * d > dot(a, a) * dot(b, b);
}

/// The smaller of Q / 0.76 (Q = 6 / sqrt(3) inradius / longest edge) and sin(smallest angle) / sin(40 degrees): below 1
/// for triangles that are worth work, 1.32 for the equilateral one.
ISOSHELL_HD inline double quality_of(PointQ8 a, PointQ8 b, PointQ8 c) {
  const Vector n = normal_of(a, b, c);
  const double ab = rounded_sqrt(double(distance_sq_q16(a, b))), bc = rounded_sqrt(double(distance_sq_q16(b, c))),
               ca = rounded_sqrt(double(distance_sq_q16(c, a))), area2 = rounded_sqrt(dot(n, n));
  if (!(area2 > 0)) return 0;
  const double longest = ab > bc ? (ab > ca ? ab : ca) : (bc > ca ? bc : ca);
  const double shortest = ab < bc ? (ab < ca ? ab : ca) : (bc < ca ? bc : ca);
  const double perimeter = ab + bc + ca;
  const double by_radius = area2 * (3.4641016151377544 / 0.76) / (perimeter * longest);
  const double by_angle = area2 / (0.6427876096865394 * longest * (perimeter - longest - shortest));
  return by_radius < by_angle ? by_radius : by_angle;
}

}  // namespace isoshell::optimize
