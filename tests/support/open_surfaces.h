// Surface meshes with borders, and what tests know of any mesh by looking at all of its triangles.
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <vector>

#include "cpu/executor_tbb.h"
#include "stages/halfedge/half_edges.h"
#include "stages/sheet/sheet_graph.h"
#include "support/soup_sheet.h"

namespace isoshell {

/// An open or closed mesh with a name.
struct NamedMesh {
  std::string name;
  std::vector<PointQ8> position;
  std::vector<TriangleIndices> triangles;
  std::vector<uint32_t> patch = {};  ///< per vertex; empty: one patch
  int64_t vertex_count() const { return int64_t(position.size()); }
};

/// A wavy sheet of n x m squares, less those where `is_hole` says so.
template <class IsHole>
NamedMesh wavy_patch(const std::string& name, int n, int m, int32_t step_q8, IsHole is_hole) {
  NamedMesh mesh{name, {}, {}};
  std::map<std::pair<int, int>, uint32_t> number;
  const auto at = [&](int i, int j) {
    const auto [found, is_new] = number.insert({{i, j}, uint32_t(mesh.position.size())});
    if (is_new)
      mesh.position.push_back({10000 + i * step_q8, 10000 + j * step_q8,
                               12000 + int32_t(600 * std::sin(i * step_q8 / 900.) * std::cos(j * step_q8 / 700.))});
    return found->second;
  };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < m; ++j) {
      if (is_hole(i, j)) continue;
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return mesh;
}
inline NamedMesh patch(int n, int m, int32_t step_q8 = 200) {
  return wavy_patch("patch", n, m, step_q8, [](int, int) { return false; });
}
inline NamedMesh patch_with_holes(int n, int m, int32_t step_q8 = 200) {
  return wavy_patch("patch with holes", n, m, step_q8, [=](int i, int j) {
    return (i == n / 4 && j == m / 2) || (i > n / 2 && i < n - 2 && j > 1 && j < m - 2);
  });
}

/// The part of a sphere above the plane z = centre, or all of it.
inline NamedMesh sphere_mesh(bool is_half, int rings, int around, double radius_q8) {
  NamedMesh mesh{is_half ? "half-sphere" : "sphere", {{20000, 20000, 20000 + int32_t(radius_q8)}}, {}};
  const double most = is_half ? 1.5707963267948966 : 3.141592653589793;
  const int last = is_half ? rings : rings - 1;
  for (int r = 1; r <= last; ++r)
    for (int k = 0; k < around; ++k) {
      const double down = most * r / rings, turn = 6.283185307179586 * k / around;
      mesh.position.push_back({20000 + int32_t(std::lround(radius_q8 * std::sin(down) * std::cos(turn))),
                               20000 + int32_t(std::lround(radius_q8 * std::sin(down) * std::sin(turn))),
                               20000 + int32_t(std::lround(radius_q8 * std::cos(down)))});
    }
  const auto at = [&](int r, int k) { return uint32_t(1 + (r - 1) * around + k % around); };
  for (int k = 0; k < around; ++k) mesh.triangles.push_back({0, at(1, k), at(1, k + 1)});
  for (int r = 1; r < last; ++r)
    for (int k = 0; k < around; ++k) {
      mesh.triangles.push_back({at(r, k), at(r + 1, k), at(r + 1, k + 1)});
      mesh.triangles.push_back({at(r, k), at(r + 1, k + 1), at(r, k + 1)});
    }
  if (is_half) return mesh;
  const auto pole = uint32_t(mesh.position.size());
  mesh.position.push_back({20000, 20000, 20000 - int32_t(radius_q8)});
  for (int k = 0; k < around; ++k) mesh.triangles.push_back({at(last, k + 1), at(last, k), pole});
  return mesh;
}

/// The neighbours of every vertex: the other corners of all triangles that have it.
template <class Triangles>
std::vector<std::set<uint32_t>> neighbours_in(const Triangles& triangles, int64_t vertices) {
  std::vector<std::set<uint32_t>> out(static_cast<size_t>(vertices));
  for (const TriangleIndices& t : triangles) {
    const uint32_t v[3] = {t.a, t.b, t.c};
    for (const uint32_t a : v)
      for (const uint32_t b : v)
        if (a != b) out[a].insert(b);
  }
  return out;
}

/// The end of every half-edge without a twin, by its start.
template <class Triangles>
std::map<uint32_t, uint32_t> border_edges_of(const Triangles& triangles) {
  std::set<std::pair<uint32_t, uint32_t>> all;
  for (const TriangleIndices& t : triangles) all.insert({{t.a, t.b}, {t.b, t.c}, {t.c, t.a}});
  std::map<uint32_t, uint32_t> out;
  for (const auto& [u, v] : all)
    if (!all.count({v, u})) out[u] = v;
  return out;
}

/// The loops of the border, each from its smallest vertex on, in the order of these.
template <class Triangles>
std::vector<std::vector<uint32_t>> border_loops_of(const Triangles& triangles) {
  std::map<uint32_t, uint32_t> next = border_edges_of(triangles);
  std::vector<std::vector<uint32_t>> loops;
  while (!next.empty()) {
    loops.push_back({});
    for (auto edge = next.begin(); edge != next.end();) {
      loops.back().push_back(edge->first);
      const uint32_t to = edge->second;
      next.erase(edge);
      edge = next.find(to);
    }
  }
  return loops;
}

/// Cuts the vertices, which must be in the order of patches and leaves, into blocks of at most so many of a leaf each.
inline void cut_into_blocks(SurfaceMesh& surface, int most = VertexBlocks::kMostVertices) {
  std::vector<int64_t> first;
  std::vector<PointQ8> centre;
  uint64_t key = ~uint64_t(0);
  for (int64_t v = 0; v < surface.vertex_count(); ++v) {
    const Voxel leaf = leaf_of_voxel(voxel_of(surface.position[v]));
    const bool same_patch = v == 0 || surface.patch.empty() || surface.patch[v] == surface.patch[v - 1];
    if (leaf_key(leaf) == key && same_patch && v - first.back() < most) continue;
    key = leaf_key(leaf);
    first.push_back(v);
    centre.push_back({leaf.x * 2048 + 1024, leaf.y * 2048 + 1024, leaf.z * 2048 + 1024});
  }
  first.push_back(surface.vertex_count());
  surface.blocks.first = to_buffer(first);
  surface.blocks.centre = to_buffer(centre);
}

/// The surface of a mesh.
inline SurfaceMesh surface_of(const NamedMesh& mesh, Context& context) {
  return make_surface_mesh({mesh.position, mesh.triangles, mesh.patch, {256, 256, 256}}, context).surface;
}

}  // namespace isoshell
