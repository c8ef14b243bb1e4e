// Inputs whose parts touch, lie in one another or share walls, and that conform: faces meet in corners and edges.
#pragma once

#include <cmath>
#include <vector>

#include "isoshell/surface_source.h"
#include "support/shapes.h"

namespace isoshell {

/// A rectangle of n by m squares of two triangles each.
inline TriangleSoup rectangle(WorldPoint corner, WorldPoint u, WorldPoint v, uint32_t n = 1, uint32_t m = 1) {
  TriangleSoup s;
  for (uint32_t j = 0; j <= m; ++j)
    for (uint32_t i = 0; i <= n; ++i) {
      const double a = double(i) / n, b = double(j) / m;
      s.vertices.push_back({corner.x + a * u.x + b * v.x, corner.y + a * u.y + b * v.y, corner.z + a * u.z + b * v.z});
    }
  for (uint32_t j = 0; j < m; ++j)
    for (uint32_t i = 0; i < n; ++i) {
      const uint32_t at = j * (n + 1) + i;
      shapes::add_triangle(s, at, at + 1, at + n + 2);
      shapes::add_triangle(s, at, at + n + 2, at + n + 1);
    }
  return s;
}

/// Cubes of side 1 along x, each with its own faces.
inline TriangleSoup cubes_in_a_row(int count) {
  TriangleSoup s;
  for (int i = 0; i < count; ++i) s = shapes::together(s, shapes::box({double(i), 0, 0}, {double(i + 1), 1, 1}));
  return s;
}

/// The same triangles, where so many that follow on each other share vertices with each other alone.
inline TriangleSoup split_vertices(const TriangleSoup& soup, size_t faces) {
  TriangleSoup s;
  for (size_t first = 0; first < soup.triangles.size(); first += faces) {
    const uint32_t base = uint32_t(s.vertices.size());
    s.vertices.insert(s.vertices.end(), soup.vertices.begin(), soup.vertices.end());
    for (size_t t = first; t < first + faces; ++t) {
      const auto& [a, b, c] = soup.triangles[t];
      shapes::add_triangle(s, base + a, base + b, base + c);
    }
  }
  return s;
}

/// A cube of side 4 with a hollow of side 2, whose faces look into the hollow.
inline TriangleSoup hollow_cube() {
  return shapes::together(shapes::box({0, 0, 0}, {4, 4, 4}), shapes::inside_out(shapes::box({1, 1, 1}, {3, 3, 3})));
}

/// Between two outlines of as many points each, one above the other.
inline void add_band(TriangleSoup& s, const std::vector<uint32_t>& below, const std::vector<uint32_t>& above) {
  for (size_t i = 0; i < below.size(); ++i) {
    const size_t next = (i + 1) % below.size();
    shapes::add_triangle(s, below[i], below[next], above[next]);
    shapes::add_triangle(s, below[i], above[next], above[i]);
  }
}

inline std::vector<uint32_t> add_ring(TriangleSoup& s, double radius, double z, uint32_t n) {
  std::vector<uint32_t> ring;
  for (uint32_t i = 0; i < n; ++i) {
    const double turn = 6.283185307179586 * (i + .5) / n, c = std::cos(turn), d = std::sin(turn);
    ring.push_back(uint32_t(s.vertices.size()));
    s.vertices.push_back({radius * c, radius * d, z});
  }
  return ring;
}

/// A cylinder of radius 1 around z between two heights, with n sides.
inline TriangleSoup cylinder(double from, double to, uint32_t n = 32) {
  TriangleSoup s;
  const auto low = add_ring(s, 1, from, n), high = add_ring(s, 1, to, n);
  add_band(s, low, high);
  for (uint32_t i = 1; i + 1 < n; ++i) {
    shapes::add_triangle(s, low[0], low[i + 1], low[i]);
    shapes::add_triangle(s, high[0], high[i], high[i + 1]);
  }
  return s;
}

/// A round plate of radius 3 and height 1 with a hole of radius 1.
inline TriangleSoup plate_with_hole(uint32_t n) {
  TriangleSoup plate;
  const auto in_low = add_ring(plate, 1, 0, n), in_high = add_ring(plate, 1, 1, n);
  const auto out_low = add_ring(plate, 3, 0, n), out_high = add_ring(plate, 3, 1, n);
  add_band(plate, out_low, out_high);
  add_band(plate, out_high, in_high);
  add_band(plate, in_high, in_low);
  add_band(plate, in_low, out_low);
  // Pins have the same triangles in the hole: those of the plate begin at the other end of their diagonals.
  for (uint32_t i = 0; i < n; ++i) {
    auto& a = plate.triangles[4 * n + 2 * i];
    auto& b = plate.triangles[4 * n + 2 * i + 1];
    const uint32_t next = (i + 1) % n;
    a = {in_low[i], in_high[next], in_low[next]};
    b = {in_low[i], in_high[i], in_high[next]};
  }
  return plate;
}

/// A pin of radius 1 in the hole of that: each is closed, and the wall of the hole is there twice.
inline TriangleSoup pin_in_a_plate(uint32_t n = 32) { return shapes::together(cylinder(0, 1, n), plate_with_hole(n)); }

}  // namespace isoshell
