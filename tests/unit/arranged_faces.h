// What arranged faces must be, and shapes that touch and cross.
#pragma once

#include <algorithm>
#include <map>

#include "geometry/segment.h"
#include "geometry/world_vector.h"
#include "repair/arrangement/arrange_faces.h"
#include "repair/arrangement/lattice_faces.h"
#include "support/catch.h"
#include "support/shapes.h"
#include "voxel/intersect.h"

namespace isoshell::arranged {

using Corners = std::array<uint32_t, 3>;

inline double area_of(const std::vector<WorldPoint>& p, const Corners& c) {
  return triangle_area(p[c[0]], p[c[1]], p[c[2]]);
}
inline WorldPoint middle_of(const std::vector<WorldPoint>& p, const Corners& c) {
  return (1. / 3) * (p[c[0]] + p[c[1]] + p[c[2]]);
}

/// Around z from the bottom up; the walls alone where it is a hole.
inline TriangleSoup cylinder(WorldPoint bottom, double radius, double height, uint32_t sides, double turned,
                             bool is_hole = false) {
  TriangleSoup s;
  for (int k = 0; k < 2; ++k)
    for (uint32_t i = 0; i < sides; ++i) {
      const double angle = turned + 6.283185307179586 * i / sides;
      s.vertices.push_back(
          {bottom.x + radius * std::cos(angle), bottom.y + radius * std::sin(angle), bottom.z + k * height});
    }
  for (int k = 0; k < 2; ++k) s.vertices.push_back({bottom.x, bottom.y, bottom.z + k * height});
  for (uint32_t i = 0; i < sides; ++i) {
    const uint32_t j = (i + 1) % sides;
    shapes::add_triangle(s, i, j, sides + j);
    shapes::add_triangle(s, i, sides + j, sides + i);
    if (is_hole) continue;
    shapes::add_triangle(s, 2 * sides, j, i);
    shapes::add_triangle(s, 2 * sides + 1, sides + i, sides + j);
  }
  return s;
}

/// The same shape with the diagonals of its sides along the other way, where it is symmetric.
inline TriangleSoup mirrored_y(TriangleSoup s, double sum) {
  for (WorldPoint& p : s.vertices) p.y = sum - p.y;
  return shapes::inside_out(std::move(s));
}

inline repair::ArrangedFaces arrange(const TriangleSoup& soup, int threads = 0) {
  Context context;
  context.threads = threads;
  WorldPoint failed_at{0, 0, 0};
  auto found = repair::arrange_faces(soup, failed_at, context);
  INFO("failed at " << failed_at.x << " " << failed_at.y << " " << failed_at.z);
  REQUIRE(found);
  return std::move(*found);
}

/// All pairs, exactly on a lattice finer than the tests' smallest distances are wide.
inline int64_t count_crossings(const repair::ArrangedFaces& faces) {
  WorldPoint least = faces.point.at(0), most = least;
  for (const WorldPoint& p : faces.point) {
    least = {std::min(least.x, p.x), std::min(least.y, p.y), std::min(least.z, p.z)};
    most = {std::max(most.x, p.x), std::max(most.y, p.y), std::max(most.z, p.z)};
  }
  // The lattice that the doc comment names, so that its points are what they were decided on.
  constexpr double kMargin = 1 << 24;
  const double a_step =
      std::max({most.x - least.x, most.y - least.y, most.z - least.z}) / (double(int64_t(1) << 40) - 2 * kMargin);
  const auto snapped = [&](const WorldPoint& p) {
    const auto round = [&](double x, double from) { return int64_t(std::floor((x - from) / a_step + kMargin + .5)); };
    return repair::StepPoint{round(p.x, least.x), round(p.y, least.y), round(p.z, least.z)};
  };
  std::vector<CornersAt<repair::StepPoint>> all;
  for (const Corners& c : faces.face)
    all.push_back(
        {{c[0], c[1], c[2]}, {snapped(faces.point[c[0]]), snapped(faces.point[c[1]]), snapped(faces.point[c[2]])}});
  int64_t count = 0;
  for (size_t i = 0; i < all.size(); ++i)
    for (size_t j = 0; j < i; ++j) count += triangles_intersect(all[i], all[j]) ? 1 : 0;
  return count;
}

/// That each triangle of the soup is the sum of its faces: their areas, their normals, and their borders.
inline void check_sources(const TriangleSoup& soup, const repair::ArrangedFaces& faces, double size) {
  REQUIRE(std::is_sorted(faces.source.begin(), faces.source.end()));
  std::vector<double> area(soup.triangles.size(), 0);
  std::vector<WorldPoint> normal(soup.triangles.size(), WorldPoint{0, 0, 0});
  for (size_t f = 0; f < faces.face.size(); ++f) {
    const uint32_t t = faces.source[f];
    const Corners& c = faces.face[f];
    area[t] += area_of(faces.point, c);
    normal[t] = normal[t] + doubled_area(faces.point[c[0]], faces.point[c[1]], faces.point[c[2]]);
  }
  double worst = 0;
  for (size_t t = 0; t < area.size(); ++t) {
    const Corners& c = soup.triangles[t];
    worst = std::max(worst, std::abs(area[t] - area_of(soup.vertices, c)));
    const WorldPoint n = doubled_area(soup.vertices[c[0]], soup.vertices[c[1]], soup.vertices[c[2]]);
    worst = std::max(worst, length(normal[t] - n));
  }
  CHECK(worst < 1e-5 * size * size);
}

/// That the edges of a triangle's faces which have no second face of it run along its own edges, all the way.
inline void check_borders(const TriangleSoup& soup, const repair::ArrangedFaces& faces, double size) {
  std::vector<double> along(soup.triangles.size(), 0);
  double off = 0;
  for (size_t begin = 0; begin < faces.face.size();) {
    const uint32_t t = faces.source[begin];
    std::map<std::array<uint32_t, 2>, int> sides;
    size_t end = begin;
    for (; end < faces.face.size() && faces.source[end] == t; ++end)
      for (size_t i = 0; i < 3; ++i) {
        const uint32_t a = faces.face[end][i], b = faces.face[end][(i + 1) % 3];
        sides[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
      }
    begin = end;
    const Corners& c = soup.triangles[t];
    for (const auto& side : sides) {
      if (side.second == 0) continue;
      const WorldPoint &a = faces.point[side.first[0]], &b = faces.point[side.first[1]];
      along[t] += length(b - a);
      double nearest = 1e300;
      for (size_t i = 0; i < 3; ++i) {
        const WorldPoint &u = soup.vertices[c[i]], &v = soup.vertices[c[(i + 1) % 3]];
        nearest = std::min(nearest, std::max(distance_to_segment(a, u, v), distance_to_segment(b, u, v)));
      }
      off = std::max(off, nearest);
    }
  }
  CHECK(off < 5e-6 * size);
  double worst = 0;
  for (size_t t = 0; t < along.size(); ++t) {
    const Corners& c = soup.triangles[t];
    double around = 0;
    for (size_t i = 0; i < 3; ++i) around += length(soup.vertices[c[(i + 1) % 3]] - soup.vertices[c[i]]);
    if (along[t] > 0) worst = std::max(worst, std::abs(along[t] - around));
  }
  CHECK(worst < 5e-5 * size);
}

inline repair::ArrangedFaces check_arranged(const TriangleSoup& soup, double size) {
  repair::ArrangedFaces faces = arrange(soup);
  CHECK(count_crossings(faces) == 0);
  check_sources(soup, faces, size);
  check_borders(soup, faces, size);
  return faces;
}

/// Faces that have the same three corners as another one, each pair once.
inline int64_t count_doubled(const repair::ArrangedFaces& faces) {
  std::map<Corners, int64_t> count;
  for (Corners c : faces.face) {
    std::sort(c.begin(), c.end());
    ++count[c];
  }
  return std::count_if(count.begin(), count.end(), [](const auto& c) { return c.second == 2; });
}
/// The area of these.
inline double doubled_area_of(const repair::ArrangedFaces& faces) {
  std::map<Corners, int64_t> count;
  double sum = 0;
  for (Corners c : faces.face) {
    std::sort(c.begin(), c.end());
    if (++count[c] == 2) sum += area_of(faces.point, c);
  }
  return sum;
}

/// Edges of closed parts have as many faces in one direction as in the other.
inline bool is_closed(const repair::ArrangedFaces& faces) {
  std::map<std::array<uint32_t, 2>, int> sides;
  for (const Corners& c : faces.face)
    for (size_t i = 0; i < 3; ++i) {
      const uint32_t a = c[i], b = c[(i + 1) % 3];
      sides[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
  return std::all_of(sides.begin(), sides.end(), [](const auto& s) { return s.second == 0; });
}

}  // namespace isoshell::arranged
