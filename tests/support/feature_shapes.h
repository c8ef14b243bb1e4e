// Small meshes with curves for tests of features, and the network that their edges make.
#pragma once

#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "features/mesh/feature_mesh.h"
#include "support/shapes.h"

namespace isoshell {

struct FeatureShape {
  std::string name;
  FeatureMesh mesh;
  CurveNetwork network;
  int patches = 1, borders = 0;  ///< of the mesh when it is cut
};

using EdgeEnds = std::pair<uint32_t, uint32_t>;
inline EdgeEnds ends(uint32_t u, uint32_t v) { return {std::min(u, v), std::max(u, v)}; }

/// The curves that the edges of one triangle, or of three and more, make with the given creases.
inline CurveNetwork network_of(const FeatureMesh& mesh, const std::set<EdgeEnds>& creases) {
  std::map<EdgeEnds, int> triangles;
  for (const auto& t : mesh.triangles)
    for (size_t i = 0; i < 3; ++i) ++triangles[ends(t[i], t[(i + 1) % 3])];
  std::map<EdgeEnds, CurveKind> left;
  for (const auto& [edge, count] : triangles) {
    if (count == 1) left[edge] = CurveKind::border;
    if (count > 2) left[edge] = CurveKind::non_manifold;
    if (count == 2 && creases.count(edge)) left[edge] = CurveKind::crease;
  }
  std::map<uint32_t, std::vector<EdgeEnds>> at;
  for (const auto& [edge, kind] : left) at[edge.first].push_back(edge), at[edge.second].push_back(edge);
  CurveNetwork network;
  std::set<uint32_t> corners;
  for (const auto& [v, edges] : at)
    if (edges.size() != 2 || left[edges[0]] != left[edges[1]]) corners.insert(v);
  network.corners.assign(corners.begin(), corners.end());
  const auto follow = [&](EdgeEnds edge, uint32_t from) {
    FeatureCurve curve{left[edge], false, {from}};
    for (uint32_t v = from;;) {
      v = edge.first == v ? edge.second : edge.first;
      left.erase(edge);
      if (v == from && !corners.count(v)) return curve.is_loop = true, curve;
      curve.vertex.push_back(v);
      if (corners.count(v)) return curve;
      edge = at[v][at[v][0] == edge ? 1 : 0];
    }
  };
  for (const uint32_t corner : network.corners)
    for (const EdgeEnds& edge : at[corner])
      if (left.count(edge)) network.curves.push_back(follow(edge, corner));
  while (!left.empty()) network.curves.push_back(follow(left.begin()->first, left.begin()->first.first));
  return network;
}

/// Squares of a plane grid where `is_there`, lifted by `height`; vertex numbers by place.
template <class IsThere, class Height>
FeatureMesh grid_mesh(uint32_t n, uint32_t m, IsThere is_there, Height height,
                      std::map<std::pair<uint32_t, uint32_t>, uint32_t>& number) {
  FeatureMesh mesh;
  const auto at = [&](uint32_t i, uint32_t j) {
    const auto [found, is_new] = number.insert({{i, j}, uint32_t(mesh.vertices.size())});
    if (is_new) mesh.vertices.push_back({double(i), double(j), height(i, j)});
    return found->second;
  };
  for (uint32_t i = 0; i < n; ++i)
    for (uint32_t j = 0; j < m; ++j) {
      if (!is_there(i, j)) continue;
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return mesh;
}

inline FeatureShape feature_cube() {
  const TriangleSoup soup = shapes::box({0, 0, 0}, {4, 4, 4});
  FeatureShape shape{"cube", {soup.vertices, soup.triangles, {}}, {}, 6, 6};
  std::set<EdgeEnds> creases;
  for (uint32_t v = 0; v < 8; ++v)
    for (const uint32_t bit : {1u, 2u, 4u}) creases.insert(ends(v, v ^ bit));
  shape.network = network_of(shape.mesh, creases);
  return shape;
}

/// Around z, with two loops and no corner.
inline FeatureShape feature_cylinder(uint32_t around) {
  FeatureShape shape{"cylinder", {}, {}, 3, 4};
  std::set<EdgeEnds> creases;
  for (uint32_t k = 0; k < around; ++k)
    for (const double z : {0., 5.}) {
      const double turn = 6.283185307179586 * k / around;
      shape.mesh.vertices.push_back({2 * std::cos(turn), 2 * std::sin(turn), z});
    }
  const uint32_t bottom = 2 * around, top = bottom + 1;
  shape.mesh.vertices.insert(shape.mesh.vertices.end(), {{0, 0, 0}, {0, 0, 5}});
  for (uint32_t k = 0; k < around; ++k) {
    const uint32_t a = 2 * k, b = 2 * ((k + 1) % around);
    shape.mesh.triangles.insert(shape.mesh.triangles.end(),
                                {{a, b, b + 1}, {a, b + 1, a + 1}, {bottom, b, a}, {top, a + 1, b + 1}});
    creases.insert({ends(a, b), ends(a + 1, b + 1)});
  }
  shape.network = network_of(shape.mesh, creases);
  return shape;
}

/// A sheet of 6 x 6 squares with a hole of one and a hole of two.
inline FeatureShape feature_plate() {
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> at;
  FeatureShape shape{"plate with holes", {}, {}, 1, 3};
  shape.mesh = grid_mesh(
      6, 6, [](uint32_t i, uint32_t j) { return !(i == 1 && j == 1) && !(i == 4 && (j == 3 || j == 4)); },
      [](uint32_t, uint32_t) { return 0.; }, at);
  shape.network = network_of(shape.mesh, {});
  return shape;
}

/// A sheet of 4 x 4 squares with creases along j = 2 from column `from` to column `to`, bent there if all along.
inline FeatureShape feature_sheet(const std::string& name, uint32_t from, uint32_t to, int patches, int borders) {
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> at;
  FeatureShape shape{name, {}, {}, patches, borders};
  const bool is_bent = to - from == 4;
  shape.mesh = grid_mesh(
      4, 4, [](uint32_t, uint32_t) { return true; },
      [&](uint32_t, uint32_t j) { return is_bent && j > 2 ? double(j - 2) : 0.; }, at);
  std::set<EdgeEnds> creases;
  for (uint32_t i = from; i < to; ++i) creases.insert(ends(at[{i, 2}], at[{i + 1, 2}]));
  shape.network = network_of(shape.mesh, creases);
  return shape;
}

/// Three squares at one edge.
inline FeatureShape feature_book() {
  FeatureShape shape{"three sheets", {}, {}, 3, 3};
  shape.mesh.vertices = {{0, 0, 0}, {0, 4, 0}, {4, 0, 0}, {4, 4, 0}, {-4, 0, 0}, {-4, 4, 0}, {0, 0, 4}, {0, 4, 4}};
  for (const uint32_t page : {2u, 4u, 6u}) {
    shape.mesh.triangles.push_back({0, page, page + 1});
    shape.mesh.triangles.push_back({0, page + 1, 1});
  }
  shape.network = network_of(shape.mesh, {});
  return shape;
}

inline std::vector<FeatureShape> feature_shapes() {
  return {feature_cube(),
          feature_cylinder(40),
          feature_plate(),
          feature_sheet("sheet", 0, 0, 1, 1),
          feature_sheet("bent sheet", 0, 4, 2, 2),
          feature_sheet("fading crease", 0, 2, 1, 1),
          feature_sheet("slit", 1, 3, 1, 2),
          feature_sheet("slit of one edge", 1, 2, 1, 2),
          feature_book()};
}

}  // namespace isoshell
