// Shapes whose borders, creases and corners are known, and counts of those that are found.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <ostream>
#include <set>
#include <utility>

#include "features/curves/find_curves.h"
#include "features/mesh/weld_for_features.h"
#include "geometry/world_vector.h"
#include "support/shapes.h"

namespace isoshell::known_curves {

inline constexpr double kTau = 6.283185307179586;

/// The surface of unit cells, each side of a cell in n x n squares.
inline TriangleSoup cells(const std::set<std::array<int, 3>>& solid, int n) {
  TriangleSoup soup;
  for (const auto& cell : solid)
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 2; ++side) {
        auto beyond = cell;
        beyond[size_t(axis)] += side ? 1 : -1;
        if (solid.count(beyond)) continue;
        const auto corner = [&](int i, int j) {
          double at[3] = {double(cell[0]), double(cell[1]), double(cell[2])};
          at[axis] += side;
          at[(axis + 1) % 3] += double(i) / n;
          at[(axis + 2) % 3] += double(j) / n;
          soup.vertices.push_back({at[0], at[1], at[2]});
          return uint32_t(soup.vertices.size() - 1);
        };
        for (int i = 0; i < n; ++i)
          for (int j = 0; j < n; ++j) {
            const uint32_t a = corner(i, j), b = corner(i + 1, j), c = corner(i + 1, j + 1), d = corner(i, j + 1);
            shapes::add_triangle(soup, a, side ? b : c, side ? c : b);
            shapes::add_triangle(soup, a, side ? c : d, side ? d : c);
          }
      }
  return soup;
}
inline TriangleSoup cube(int n) { return cells({{0, 0, 0}}, n); }

/// A closed body between z = 0 and z = height over a regular polygon, wider or narrower on top.
inline TriangleSoup cylinder(uint32_t segments, uint32_t layers, double height, double radius_on_top = 1) {
  TriangleSoup soup;
  for (uint32_t k = 0; k <= layers; ++k)
    for (uint32_t i = 0; i < segments; ++i) {
      const double r = 1 + (radius_on_top - 1) * k / layers;
      soup.vertices.push_back(
          {r * std::cos(kTau * i / segments), r * std::sin(kTau * i / segments), height * k / layers});
    }
  const auto at = [&](uint32_t k, uint32_t i) { return k * segments + i % segments; };
  for (uint32_t i = 0; i < segments; ++i)
    for (uint32_t k = 0; k < layers; ++k) {
      shapes::add_triangle(soup, at(k, i), at(k, i + 1), at(k + 1, i + 1));
      shapes::add_triangle(soup, at(k, i), at(k + 1, i + 1), at(k + 1, i));
    }
  for (const bool is_top : {false, true}) {
    const auto centre = uint32_t(soup.vertices.size());
    const uint32_t k = is_top ? layers : 0;
    soup.vertices.push_back({0, 0, is_top ? height : 0});
    for (uint32_t i = 0; i < segments; ++i)
      shapes::add_triangle(soup, centre, at(k, is_top ? i : i + 1), at(k, is_top ? i + 1 : i));
  }
  return soup;
}

/// A square plate, 4 wide, with a round hole of radius 1 in 4 m segments.
inline TriangleSoup plate_with_round_hole(uint32_t m) {
  TriangleSoup soup;
  const uint32_t n = 4 * m;
  for (const double z : {0., .5})
    for (const bool is_outer : {false, true})
      for (uint32_t i = 0; i < n; ++i) {
        const double x = std::cos(kTau * (i + .5 * m) / n), y = std::sin(kTau * (i + .5 * m) / n);
        double s = 1;
        if (is_outer) s = 2 / std::max(std::abs(x), std::abs(y));
        const bool is_corner = is_outer && i % m == 0;
        soup.vertices.push_back(is_corner ? WorldPoint{x < 0 ? -2. : 2., y < 0 ? -2. : 2., z}
                                          : WorldPoint{s * x, s * y, z});
      }
  const auto quad = [&](uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    shapes::add_triangle(soup, a, b, c);
    shapes::add_triangle(soup, a, c, d);
  };
  for (uint32_t i = 0; i < n; ++i) {
    const uint32_t j = (i + 1) % n;
    quad(i, j, n + j, n + i);                          // below
    quad(2 * n + j, 2 * n + i, 3 * n + i, 3 * n + j);  // above
    quad(j, i, 2 * n + i, 2 * n + j);                  // in the hole
    quad(n + i, n + j, 3 * n + j, 3 * n + i);          // around
  }
  return soup;
}

/// n x m squares of this step, bent along the middle by so many degrees.
inline TriangleSoup sheet(int n, int m, double step, double degrees = 0) {
  TriangleSoup soup;
  const double turn = degrees * kTau / 360;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= m; ++j) {
      const double x = (i - n / 2) * step, y = j * step;
      soup.vertices.push_back(x <= 0 ? WorldPoint{x, y, 0} : WorldPoint{x * std::cos(turn), y, x * std::sin(turn)});
    }
  const auto at = [&](int i, int j) { return uint32_t(i * (m + 1) + j); };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < m; ++j) {
      shapes::add_triangle(soup, at(i, j), at(i + 1, j), at(i + 1, j + 1));
      shapes::add_triangle(soup, at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  return soup;
}

/// Every position after a map that takes equal positions to equal ones.
inline TriangleSoup moved(TriangleSoup soup, const std::function<WorldPoint(const WorldPoint&)>& map) {
  for (WorldPoint& p : soup.vertices) p = map(p);
  return soup;
}
inline TriangleSoup turned(TriangleSoup soup) {
  const double a = .7137, b = 1.1923;
  return moved(std::move(soup), [=](const WorldPoint& p) {
    const double x = std::cos(a) * p.x - std::sin(a) * p.y, y = std::sin(a) * p.x + std::cos(a) * p.y;
    return WorldPoint{x, std::cos(b) * y - std::sin(b) * p.z, std::sin(b) * y + std::cos(b) * p.z};
  });
}
/// Every coordinate off by at most so much, at random.
inline TriangleSoup shaken(TriangleSoup soup, double most) {
  std::map<std::array<double, 3>, uint64_t> number;
  return moved(std::move(soup), [&, most](const WorldPoint& p) {
    const uint64_t n = number.insert({{p.x, p.y, p.z}, number.size()}).first->second;
    const auto off = [&](uint64_t axis) {
      return most * (2 * double(random_bits(7, 3 * n + axis) >> 11) / 9007199254740992.0 - 1);
    };
    return WorldPoint{p.x + off(0), p.y + off(1), p.z + off(2)};
  });
}

inline CurveNetwork curves_of(const TriangleSoup& soup, double edge_length_world) {
  return find_curves(weld_for_features(soup), {CreaseMode::automatic, 0, edge_length_world});
}

struct Counts {
  int64_t creases = 0, borders = 0, non_manifold = 0, loops = 0, corners = 0;
  bool operator==(const Counts& o) const {
    return creases == o.creases && borders == o.borders && non_manifold == o.non_manifold && loops == o.loops &&
           corners == o.corners;
  }
};
inline std::ostream& operator<<(std::ostream& out, const Counts& c) {
  return out << c.creases << " creases, " << c.borders << " borders, " << c.non_manifold << " non-manifold, " << c.loops
             << " loops, " << c.corners << " corners";
}

inline Counts counts_of(const CurveNetwork& network) {
  Counts n;
  for (const FeatureCurve& c : network.curves) {
    n.creases += c.kind == CurveKind::crease;
    n.borders += c.kind == CurveKind::border;
    n.non_manifold += c.kind == CurveKind::non_manifold;
    n.loops += c.is_loop;
  }
  n.corners = int64_t(network.corners.size());
  return n;
}
inline Counts counts_of(const TriangleSoup& soup, double edge_length_world) {
  return counts_of(curves_of(soup, edge_length_world));
}
inline Counts only_creases(int64_t creases, int64_t loops, int64_t corners) { return {creases, 0, 0, loops, corners}; }

}  // namespace isoshell::known_curves
