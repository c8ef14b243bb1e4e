// Closed surfaces with parts that are about as thin as a voxel.
#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "support/shapes.h"

namespace isoshell::shapes {

/// A turn off the axes, so that no wall lies along voxels.
inline WorldPoint tilted(WorldPoint p) {
  const double x = .8 * p.x - .6 * p.y, y = .6 * p.x + .8 * p.y;
  return {x, .96 * y - .28 * p.z, .28 * y + .96 * p.z};
}
inline WorldPoint tilted_back(WorldPoint p) {
  const double y = .96 * p.y + .28 * p.z, z = .96 * p.z - .28 * p.y;
  return {.8 * p.x + .6 * y, .8 * y - .6 * p.x, z};
}
inline TriangleSoup tilted(TriangleSoup soup) {
  for (WorldPoint& p : soup.vertices) p = tilted(p);
  return soup;
}

/// A square of side 1 and this thickness.
inline TriangleSoup plate(double thickness) { return box({0, 0, 0}, {1, 1, thickness}); }

/// A ball's surface and another one inside of it: the wall between them is solid.
inline TriangleSoup wall_around_hollow(double radius, double thickness) {
  return together(sphere({0, 0, 0}, radius, 96), inside_out(sphere({0, 0, 0}, radius - thickness, 96)));
}

/// A unit ball with a disc of this thickness and radius 1.5 around its equator.
inline TriangleSoup ball_with_fin(double thickness) {
  constexpr uint32_t kAround = 128, kRows = 24, kAcross = 8;
  const double z = thickness / 2, tau = 6.283185307179586, foot = std::asin(z);
  std::vector<std::pair<double, double>> half;  // radius and height, from below the pole outwards
  for (uint32_t j = 1; j <= kRows; ++j) {
    const double lat = tau / 4 - (tau / 4 - foot) * j / kRows;
    half.push_back({std::cos(lat), std::sin(lat)});
  }
  for (uint32_t j = 1; j <= kAcross; ++j) half.push_back({std::cos(foot) + (1.5 - std::cos(foot)) * j / kAcross, z});
  TriangleSoup soup;
  const auto add_ring = [&](double radius, double height) {
    for (uint32_t i = 0; i < kAround; ++i)
      soup.vertices.push_back({radius * std::cos(tau * i / kAround), radius * std::sin(tau * i / kAround), height});
  };
  for (const auto& [radius, height] : half) add_ring(radius, height);
  for (size_t j = half.size(); j-- > 0;) add_ring(half[j].first, -half[j].second);
  const auto rings = uint32_t(2 * half.size()), top = uint32_t(soup.vertices.size()), bottom = top + 1;
  soup.vertices.push_back({0, 0, 1});
  soup.vertices.push_back({0, 0, -1});
  for (uint32_t i = 0; i < kAround; ++i) {
    const uint32_t next = (i + 1) % kAround, last = (rings - 1) * kAround;
    add_triangle(soup, top, i, next);
    add_triangle(soup, bottom, last + next, last + i);
    for (uint32_t j = 0; j + 1 < rings; ++j) {
      const uint32_t a = j * kAround + i, b = j * kAround + next;
      add_triangle(soup, a, a + kAround, b + kAround);
      add_triangle(soup, a, b + kAround, b);
    }
  }
  soup.faces_in_file = int64_t(soup.triangles.size());
  return soup;
}

}  // namespace isoshell::shapes
