// Test shapes made by code: small, known, and ugly where that is the point.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "isoshell/surface_source.h"
#include "voxel/random.h"

namespace isoshell::shapes {

inline void add_triangle(TriangleSoup& soup, uint32_t a, uint32_t b, uint32_t c) {
  soup.triangles.push_back({a, b, c});
}

/// Axis-aligned box, 12 outward triangles.
inline TriangleSoup box(WorldPoint lo, WorldPoint hi) {
  TriangleSoup s;
  for (int i = 0; i < 8; ++i) s.vertices.push_back({i & 1 ? hi.x : lo.x, i & 2 ? hi.y : lo.y, i & 4 ? hi.z : lo.z});
  const uint32_t quads[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (const auto& q : quads) {
    add_triangle(s, q[0], q[1], q[2]);
    add_triangle(s, q[0], q[2], q[3]);
  }
  s.faces_in_file = int64_t(s.triangles.size());
  return s;
}

/// Torus around z, outward: major radius R, tube radius r, `n` by `m` quads. Genus 1.
inline TriangleSoup torus(double R, double r, uint32_t n, uint32_t m) {
  TriangleSoup s;
  const double tau = 6.283185307179586;
  for (uint32_t i = 0; i < n; ++i)
    for (uint32_t j = 0; j < m; ++j) {
      const double u = tau * i / n, v = tau * j / m;
      s.vertices.push_back({(R + r * std::cos(v)) * std::cos(u), (R + r * std::cos(v)) * std::sin(u), r * std::sin(v)});
    }
  for (uint32_t i = 0; i < n; ++i)
    for (uint32_t j = 0; j < m; ++j) {
      const uint32_t a = i * m + j, b = (i + 1) % n * m + j, c = (i + 1) % n * m + (j + 1) % m, d = i * m + (j + 1) % m;
      add_triangle(s, a, b, c);
      add_triangle(s, a, c, d);
    }
  s.faces_in_file = int64_t(s.triangles.size());
  return s;
}

/// Sphere of `n` meridians and `n / 2` parallels, outward.
inline TriangleSoup sphere(WorldPoint centre, double radius, uint32_t n) {
  TriangleSoup s;
  const double tau = 6.283185307179586;
  const uint32_t rows = n / 2;
  s.vertices.push_back({centre.x, centre.y, centre.z - radius});
  for (uint32_t j = 1; j < rows; ++j)
    for (uint32_t i = 0; i < n; ++i) {
      const double lat = tau / 2 * j / rows - tau / 4, lon = tau * i / n;
      s.vertices.push_back({centre.x + radius * std::cos(lat) * std::cos(lon),
                            centre.y + radius * std::cos(lat) * std::sin(lon), centre.z + radius * std::sin(lat)});
    }
  s.vertices.push_back({centre.x, centre.y, centre.z + radius});
  const uint32_t top = uint32_t(s.vertices.size() - 1);
  const auto at = [&](uint32_t j, uint32_t i) { return 1 + (j - 1) * n + i % n; };
  for (uint32_t i = 0; i < n; ++i) {
    add_triangle(s, 0, at(1, i + 1), at(1, i));
    for (uint32_t j = 1; j + 1 < rows; ++j) {
      add_triangle(s, at(j, i), at(j, i + 1), at(j + 1, i + 1));
      add_triangle(s, at(j, i), at(j + 1, i + 1), at(j + 1, i));
    }
    add_triangle(s, top, at(rows - 1, i), at(rows - 1, i + 1));
  }
  s.faces_in_file = int64_t(s.triangles.size());
  return s;
}

/// The same faces seen from the other side.
inline TriangleSoup inside_out(TriangleSoup soup) {
  for (auto& t : soup.triangles) std::swap(t[1], t[2]);
  return soup;
}

/// Both soups in one.
inline TriangleSoup together(TriangleSoup a, const TriangleSoup& b) {
  const uint32_t base = uint32_t(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& t : b.triangles) add_triangle(a, t[0] + base, t[1] + base, t[2] + base);
  a.faces_in_file += b.faces_in_file;
  return a;
}

/// Two parallel squares `gap` apart, each `side` wide: an open double wall.
inline TriangleSoup two_sheets(double side, double gap) {
  TriangleSoup s;
  for (int k = 0; k < 2; ++k)
    for (int i = 0; i < 4; ++i) s.vertices.push_back({i & 1 ? side : 0, i & 2 ? side : 0, k * gap});
  for (uint32_t k = 0; k < 2; ++k) {
    add_triangle(s, 4 * k, 4 * k + 1, 4 * k + 3);
    add_triangle(s, 4 * k, 4 * k + 3, 4 * k + 2);
  }
  s.faces_in_file = 4;
  return s;
}

/// Triangles of three random corners each in a cube of this side; edges up to `reach`.
inline TriangleSoup random_soup(uint32_t count, double side, double reach, uint64_t seed) {
  TriangleSoup s;
  uint64_t next = 0;
  const auto unit = [&] { return double(random_bits(seed, next++) >> 11) / 9007199254740992.0; };
  for (uint32_t i = 0; i < count; ++i) {
    const WorldPoint at = {unit() * side, unit() * side, unit() * side};
    for (int k = 0; k < 3; ++k)
      s.vertices.push_back({at.x + unit() * reach, at.y + unit() * reach, at.z + unit() * reach});
    add_triangle(s, 3 * i, 3 * i + 1, 3 * i + 2);
  }
  s.faces_in_file = count;
  return s;
}

/// The same surface with vertices and faces in another order, and faces that start at another corner.
inline TriangleSoup shuffled(const TriangleSoup& soup, uint64_t seed) {
  const auto order = [&](size_t count, uint64_t stream) {
    std::vector<uint32_t> o(count);
    for (size_t i = 0; i < count; ++i) o[i] = uint32_t(i);
    for (size_t i = count; i > 1; --i) std::swap(o[i - 1], o[random_bits(seed + stream, i) % i]);
    return o;
  };
  const std::vector<uint32_t> vertices = order(soup.vertices.size(), 0), faces = order(soup.triangles.size(), 1);
  TriangleSoup s = soup;
  std::vector<uint32_t> to(vertices.size());
  for (size_t i = 0; i < vertices.size(); ++i) {
    s.vertices[i] = soup.vertices[vertices[i]];
    to[vertices[i]] = uint32_t(i);
  }
  for (size_t i = 0; i < faces.size(); ++i) {
    const auto& t = soup.triangles[faces[i]];
    const size_t turn = random_bits(seed + 2, i) % 3;
    s.triangles[i] = {to[t[turn]], to[t[(turn + 1) % 3]], to[t[(turn + 2) % 3]]};
  }
  return s;
}

}  // namespace isoshell::shapes

namespace isoshell {

/// Enclosed volume of a closed surface, positive where it faces outward.
inline double volume(const TriangleSoup& soup) {
  double six = 0;
  for (const auto& t : soup.triangles) {
    const WorldPoint &a = soup.vertices[t[0]], &b = soup.vertices[t[1]], &c = soup.vertices[t[2]];
    six += a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x);
  }
  return six / 6;
}

}  // namespace isoshell
