// The inputs of whole runs in the golden file, made by code: what people give, and as ugly as they give it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "geometry/given_surface.h"
#include "isoshell/attribute.h"
#include "isoshell/io/memory_input.h"
#include "isoshell/io/point_file.h"
#include "regions/part_soups.h"
#include "support/shapes.h"
#include "support/thin_shapes.h"
#include "unit/region_cubes.h"

namespace isoshell::golden {

constexpr double kTurn = 6.283185307179586;

/// A torus that is twisted about its axis, more from frame to frame.
inline TriangleSoup twisted_torus(int frame) {
  TriangleSoup soup = shapes::torus(2, 0.7, 64, 32);
  for (WorldPoint& p : soup.vertices) {
    const double angle = 0.06 * frame * p.x;
    p = {p.x, p.y * std::cos(angle) - p.z * std::sin(angle), p.y * std::sin(angle) + p.z * std::cos(angle)};
  }
  return soup;
}

/// A torus with a colour at its vertices, and texture coordinates that jump where its angles begin again.
inline TriangleSoup painted_torus() {
  TriangleSoup soup = shapes::torus(2, 0.7, 64, 32);
  Attribute color{"color", NumberType::u8, 3, {}}, uv{"uv", NumberType::f32, 2, {}, AttributeDomain::corner};
  for (const WorldPoint& p : soup.vertices)
    color.values.insert(color.values.end(), {(p.x + 3) / 6, (p.y + 3) / 6, (p.z + 1) / 2});
  for (const auto& t : soup.triangles) {
    std::array<std::array<double, 2>, 3> corner;
    for (size_t i = 0; i < 3; ++i) {
      const WorldPoint p = soup.vertices[t[i]];
      corner[i] = {std::atan2(p.y, p.x) / kTurn, std::atan2(p.z, std::hypot(p.x, p.y) - 2) / kTurn};
    }
    for (size_t axis = 0; axis < 2; ++axis) {
      const double most = std::max({corner[0][axis], corner[1][axis], corner[2][axis]});
      for (auto& c : corner) c[axis] += c[axis] < most - 0.5 ? 1 : 0;
    }
    for (const auto& c : corner) uv.values.insert(uv.values.end(), c.begin(), c.end());
  }
  soup.attributes = {color, uv};
  return soup;
}

/// The part of a torus where x is above 0: two borders.
inline TriangleSoup half_torus() {
  TriangleSoup soup = shapes::torus(2, 0.6, 64, 32);
  std::vector<std::array<uint32_t, 3>> kept;
  for (const auto& t : soup.triangles)
    if (soup.vertices[t[0]].x > 0 && soup.vertices[t[1]].x > 0 && soup.vertices[t[2]].x > 0) kept.push_back(t);
  soup.triangles = kept;
  return soup;
}

/// A box without its lid: a border along creases.
inline TriangleSoup open_box() {
  TriangleSoup soup = shapes::box({0, 0, 0}, {3, 2, 1});
  soup.triangles.resize(10);
  return soup;
}

/// A torus with two holes and a fin, of which every 37th face looks inward and every 41st is there twice.
inline TriangleSoup dirty_torus() {
  TriangleSoup soup = shapes::torus(2, 0.7, 64, 32);
  const std::vector<std::array<uint32_t, 3>> faces = soup.triangles;
  soup.triangles.clear();
  for (size_t t = 0; t < faces.size(); ++t) {
    const auto [a, b, c] = faces[t];
    if ((t >= 200 && t < 206) || (t >= 3000 && t < 3012)) continue;
    soup.triangles.push_back(t % 37 == 0 ? std::array<uint32_t, 3>{a, c, b} : faces[t]);
    if (t % 41 == 0) soup.triangles.push_back({b, c, a});
  }
  soup.vertices.push_back({3.1, 0.1, 0.1});
  shapes::add_triangle(soup, 0, 1, uint32_t(soup.vertices.size() - 1));
  return soup;
}

/// So many points on a torus along a spiral by the golden ratio, without normals.
inline PointCloud points_of_torus(int count) {
  PointCloud cloud;
  for (int i = 0; i < count; ++i) {
    const double u = kTurn * i / count, v = kTurn * 0.6180339887498949 * i, r = 2 + 0.7 * std::cos(v);
    cloud.position.push_back({r * std::cos(u), r * std::sin(u), 0.7 * std::sin(v)});
  }
  return cloud;
}

/// Points on the faces of a box, as far apart along both sides, without normals.
inline PointCloud points_of_box(const std::array<int, 3>& squares) {
  PointCloud cloud;
  for (size_t axis = 0; axis < 3; ++axis)
    for (int i = 0; i < squares[(axis + 1) % 3]; ++i)
      for (int j = 0; j < squares[(axis + 2) % 3]; ++j)
        for (const int side : {0, squares[axis]}) {
          std::array<double, 3> at{};
          at[axis] = side;
          at[(axis + 1) % 3] = i + 0.5;
          at[(axis + 2) % 3] = j + 0.5;
          cloud.position.push_back({at[0], at[1], at[2]});
        }
  return cloud;
}

/// Two boxes through each other, none of whose faces lie along one another.
inline TriangleSoup crossing_boxes() {
  return shapes::together(shapes::box({-2, -0.6, -0.4}, {2, 0.6, 0.4}),
                          shapes::tilted(shapes::box({-0.5, -0.4, -2}, {0.4, 0.5, 2})));
}

/// A cube of unit cubes that are closed each, with their faces between them.
inline TriangleSoup blocks(int side) {
  TriangleSoup soup;
  for (int n = 0; n < side * side * side; ++n) {
    const double x = n % side, y = n / side % side, z = n / (side * side);
    soup = shapes::together(soup, shapes::box({x, y, z}, {x + 1, y + 1, z + 1}));
  }
  return soup;
}

/// Two boxes that overlap; the faces of the second one look inward.
inline TriangleSoup mixed_boxes() {
  return shapes::together(shapes::box({0, 0, 0}, {2, 2, 2}),
                          shapes::inside_out(shapes::box({1, 0.7, 0.5}, {3, 1.5, 1.4})));
}

/// Triangles of a box that share no vertices, a wall that parts it, and one across both that reaches out of it.
inline TriangleSoup box_with_walls() {
  const TriangleSoup within = rectangle({1, 0, 0}, {0, 2, 0}, {0, 0, 1});
  const TriangleSoup across = rectangle({-0.5, 0.6, -0.5}, {4, 0.5, 0}, {0, 0, 2});
  return split_vertices(shapes::together(shapes::together(shapes::box({0, 0, 0}, {3, 2, 1}), within), across), 1);
}

/// Six cubes of three regions, which share their walls.
inline TriangleSoup labelled_cubes() { return surface_of(mesh_of(LabelledCubes{{3, 2, 1}, {1, 2, 2, 3, 1, 3}})); }

/// A plate of this width, bent to an arc of radius 1, 0.2 thick at its ends and this thick in the middle: there the
/// triangles of its two sides may intersect.
inline TriangleSoup bent_plate(double width, double least_thickness) {
  constexpr uint32_t kSteps = 24;
  TriangleSoup soup;
  for (uint32_t i = 0; i <= kSteps; ++i) {
    const double turn = 2.5 * i / kSteps, off = 2. * i / kSteps - 1;
    const double inner = 1 - least_thickness - (0.2 - least_thickness) * off * off;
    for (const auto& [radius, z] : {std::pair(1., 0.), {1., width}, {inner, width}, {inner, 0.}})
      soup.vertices.push_back({radius * std::cos(turn), radius * std::sin(turn), z});
  }
  for (uint32_t i = 0; i < kSteps; ++i)
    add_band(soup, {4 * i, 4 * i + 3, 4 * i + 2, 4 * i + 1}, {4 * i + 4, 4 * i + 7, 4 * i + 6, 4 * i + 5});
  soup.triangles.insert(soup.triangles.end(), {{0, 1, 2}, {0, 2, 3}});
  const uint32_t end = 4 * kSteps;
  soup.triangles.insert(soup.triangles.end(), {{end, end + 2, end + 1}, {end, end + 3, end + 2}});
  return soup;
}

/// Distances to a torus at the points of a lattice, negative inside.
inline Input distances_to_torus() {
  constexpr int kSize[3] = {64, 64, 24};
  constexpr double kStep = 0.1;
  const WorldPoint first{-3.15, -3.15, -1.15};
  std::vector<float> values;
  for (int i = 0; i < kSize[0]; ++i)
    for (int j = 0; j < kSize[1]; ++j)
      for (int k = 0; k < kSize[2]; ++k) {
        const double x = first.x + i * kStep, y = first.y + j * kStep, z = first.z + k * kStep;
        const double around = std::sqrt(x * x + y * y) - 2;
        values.push_back(float(std::sqrt(around * around + z * z) - 0.7));
      }
  DenseVolume volume;
  volume.values = values.data();
  for (size_t axis = 0; axis < 3; ++axis) volume.size[axis] = kSize[axis];
  volume.stride[0] = kSize[1] * kSize[2], volume.stride[1] = kSize[2], volume.stride[2] = 1;
  volume.step_world = {WorldPoint{kStep, 0, 0}, WorldPoint{0, kStep, 0}, WorldPoint{0, 0, kStep}};
  volume.origin_world = first;
  return input_of(volume, "volume", VolumeReadOptions());
}

}  // namespace isoshell::golden
