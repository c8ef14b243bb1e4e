// Meshes with borders as the dual, collapsing and the optimisation leave them, and what must hold of every one.
#pragma once

#include <functional>

#include "isoshell/advanced/stages.h"
#include "isoshell/mesh_topology.h"
#include "support/catch.h"
#include "support/cut_surfaces.h"

namespace isoshell {

/// A surface, and the border vertices that are seeds.
struct FixedCase {
  NamedMesh mesh;
  std::function<bool(PointQ8)> is_seed;
  std::vector<std::array<int32_t, 3>> corners = {};  ///< of a cut box
};

inline std::vector<FixedCase> fixed_cases() {
  const auto box = [](std::array<int, 3> squares, int every) {
    constexpr int32_t kStep = 100;
    FixedCase out{cut_box(squares, kStep), {}, {}};
    out.is_seed = [=](PointQ8 p) {
      const int32_t at[3] = {(p.x - 10000) / kStep, (p.y - 10000) / kStep, (p.z - 10000) / kStep};
      for (int k = 0; k < 3; ++k)
        if (at[k] % every != 0 && at[k] != squares[size_t(k)]) return false;
      return true;
    };
    for (int i = 0; i < 8; ++i)
      out.corners.push_back({10000 + (i & 1) * squares[0] * kStep, 10000 + (i >> 1 & 1) * squares[1] * kStep,
                             10000 + (i >> 2) * squares[2] * kStep});
    return out;
  };
  const auto every = [](NamedMesh mesh, int32_t n) {
    return FixedCase{std::move(mesh), [=](PointQ8 p) { return (p.x / 7 + p.y / 11) % n == 0; }, {}};
  };
  std::vector<FixedCase> out;
  out.push_back(box({20, 20, 20}, 5));
  out.push_back(box({30, 20, 10}, 4));
  out.push_back(box({12, 12, 12}, 12));
  out.push_back(every(patch(60, 50, 90), 6));
  out.push_back({patch_with_holes(60, 50, 90), [](PointQ8 p) {
                   const bool at_small_hole = std::abs(p.x - 11395) < 90 && std::abs(p.y - 12295) < 90;
                   return at_small_hole || (p.x / 7 + p.y / 11) % 3 == 0;
                 }});
  out.push_back(every(sphere_mesh(true, 30, 90, 5000), 5));
  return out;
}

inline std::map<std::pair<uint32_t, uint32_t>, int> edge_counts(const DualMesh& mesh) {
  std::map<std::pair<uint32_t, uint32_t>, int> out;
  for (const TriangleIndices& t : mesh.triangles)
    for (const auto& [u, v] : {std::pair{t.a, t.b}, {t.b, t.c}, {t.c, t.a}}) ++out[std::minmax(u, v)];
  return out;
}

template <class Triangles>
int64_t euler_of(const Triangles& triangles, int64_t vertices) {
  std::set<std::pair<uint32_t, uint32_t>> edges;
  for (const TriangleIndices& t : triangles)
    for (const auto& [u, v] : {std::pair{t.a, t.b}, {t.b, t.c}, {t.c, t.a}}) edges.insert(std::minmax(u, v));
  return vertices - int64_t(edges.size()) + triangles.size();
}

/// Fixed seeds as their borders pass them: for each the next one.
inline std::map<uint32_t, uint32_t> fixed_polygons(const SurfaceMesh& surface, const SeedSet& seeds) {
  std::map<uint32_t, uint32_t> next;
  for (const auto& [u, v] : border_edges_of(surface.triangles)) {
    const uint32_t a = seeds.fixed.of_vertex[u], b = seeds.fixed.of_vertex[v];
    if (a != b) next[a] = b;
  }
  return next;
}

inline void check_fixed_unchanged(const SeedSet& before, const SeedSet& after) {
  const FixedSeeds &a = before.fixed, &b = after.fixed;
  REQUIRE(a.count == b.count);
  CHECK(std::equal(before.position.begin(), before.position.begin() + a.count, after.position.begin()));
  CHECK(std::equal(before.home.begin(), before.home.begin() + a.count, after.home.begin()));
  for (int64_t s = 0; s < a.count; ++s)
    CHECK((before.normal[s].x == after.normal[s].x && before.normal[s].y == after.normal[s].y &&
           before.normal[s].z == after.normal[s].z));
  CHECK(std::equal(a.of_vertex.begin(), a.of_vertex.end(), b.of_vertex.begin(), b.of_vertex.end()));
  CHECK(std::equal(a.joined.begin(), a.joined.end(), b.joined.begin(), b.joined.end()));
}

/// A canonical triangulation of the surface by all seeds, with the polygons of the fixed ones as its border.
inline void check_open_mesh(const SurfaceMesh& surface, const SeedSet& seeds, const DualMesh& mesh) {
  REQUIRE(mesh.position.size() == seeds.size());
  CHECK(std::equal(mesh.position.begin(), mesh.position.begin() + seeds.fixed.count, seeds.position.begin()));
  CHECK(border_edges_of(mesh.triangles) == fixed_polygons(surface, seeds));
  CHECK(euler_of(mesh.triangles, mesh.position.size()) == euler_of(surface.triangles, surface.vertex_count()));
  const MeshTopology topology = check_mesh(mesh.triangles.view(), mesh.position.size());
  CHECK(topology.manifold);
  CHECK(topology.unreferenced_vertices == 0);
  for (int64_t t = 0; t < mesh.triangles.size(); ++t) {
    const TriangleIndices i = mesh.triangles[t];
    CHECK((i.a < i.b && i.a < i.c));
    if (t > 0) CHECK(less_corners(mesh.triangles[t - 1], i));
  }
}

/// Of a cut box: closed, of genus 0, every corner a vertex and every edge of the box covered by edges.
inline void check_joined(const FixedCase& from, const DualMesh& joined) {
  int64_t most = 0;
  for (const auto& [edge, count] : edge_counts(joined)) most = std::max<int64_t>(most, count);
  CHECK(most == 2);
  if (from.corners.empty()) return;
  const MeshTopology topology = check_mesh(joined.triangles.view(), joined.position.size());
  CHECK(topology.is_closed_manifold());
  CHECK(topology.components == 1);
  CHECK(topology.genus == 0);
  const auto on_edges = [&](PointQ8 p, int axis) {  // of the box, along this axis
    const int32_t at[3] = {p.x, p.y, p.z};
    for (int k = 0; k < 3; ++k)
      if (k != axis && at[k] != from.corners[0][size_t(k)] && at[k] != from.corners[7][size_t(k)]) return false;
    return true;
  };
  double covered = 0, expected = 0;
  for (const auto& [edge, count] : edge_counts(joined)) {
    const PointQ8 p = joined.position[edge.first], q = joined.position[edge.second];
    for (int axis = 0; axis < 3; ++axis) {
      const int32_t d[3] = {q.x - p.x, q.y - p.y, q.z - p.z};
      const bool along = d[(axis + 1) % 3] == 0 && d[(axis + 2) % 3] == 0;
      if (along && on_edges(p, axis) && on_edges(q, axis)) covered += std::abs(d[axis]);
    }
  }
  for (size_t axis = 0; axis < 3; ++axis) expected += 4. * (from.corners[7][axis] - from.corners[0][axis]);
  CHECK(covered == expected);
  for (const auto& c : from.corners) {
    int64_t found = 0;
    for (const PointQ8& p : joined.position) found += p == PointQ8{c[0], c[1], c[2]};
    CHECK(found == 1);
  }
}

}  // namespace isoshell
