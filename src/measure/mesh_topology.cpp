// check_mesh: half-edges are matched by their edges.
#include "isoshell/mesh_topology.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <string>
#include <vector>

#include "geometry/half_edges.h"
#include "geometry/triangle_list.h"
#include "isoshell/error.h"
#include "measure/complex_counts.h"

namespace isoshell {
namespace {

using Triangles = std::vector<std::array<uint32_t, 3>>;

class Checker {
 public:
  /// Of triangles that repeat no corner.
  Checker(const Triangles& triangles, int64_t vertex_count)
      : vertex_count_(vertex_count), triangles_(triangles), sides_(find_edge_sides(triangles, size_t(vertex_count))) {}

  MeshTopology run(int64_t degenerate) {
    found_.degenerate_triangles = degenerate;
    match_half_edges();
    count_vertices();
    count_repeats();
    found_.euler = referenced_ - edges_ + int64_t(triangles_.size());
    found_.closed = !triangles_.empty() && found_.boundary_edges == 0;
    found_.manifold = found_.nonmanifold_edges == 0 && found_.nonmanifold_vertices == 0 &&
                      found_.repeated_triangles == 0 && found_.degenerate_triangles == 0;
    if (found_.manifold) found_.genus = (2 * found_.components - found_.boundary_loops - found_.euler) / 2;
    return found_;
  }

 private:
  uint32_t corner(uint32_t half_edge) const { return triangles_[half_edge / 3][half_edge % 3]; }
  uint32_t half_edges() const { return uint32_t(sides_.items.size()); }

  /// Joins corners around their vertex through edges with two faces, vertices through all edges.
  void match_half_edges() {
    IndexSets fans(half_edges()), vertices(vertex_count_);
    std::vector<uint32_t> boundary;
    for_each_edge(sides_, [&](uint32_t u, uint32_t v, View<const EdgeSide> on_edge) {
      const uint32_t one = on_edge[0].half_edge, other = on_edge[on_edge.size - 1].half_edge;
      ++edges_;
      vertices.unite(u, v);
      if (on_edge.size == 1)
        boundary.push_back(one);
      else if (on_edge.size > 2 || corner(one) == corner(other))
        ++found_.nonmanifold_edges;
      else {
        fans.unite(one, next_in_triangle(other));
        fans.unite(next_in_triangle(one), other);
      }
    });
    found_.boundary_edges = int64_t(boundary.size());
    count_fans(fans, vertices);
    found_.boundary_loops = count_loops(fans, boundary, half_edges());
  }

  void count_fans(IndexSets& fans, IndexSets& vertices) {
    fans_.assign(size_t(vertex_count_), 0);
    for (uint32_t h = 0; h < half_edges(); ++h)
      if (fans.root(h) == h) ++fans_[corner(h)];
    for (uint32_t v = 0; v < vertex_count_; ++v)
      if (fans_[v] > 0 && vertices.root(v) == v) ++found_.components;
  }

  void count_vertices() {
    for (uint32_t n : fans_) {
      if (n == 0)
        ++found_.unreferenced_vertices;
      else
        ++referenced_;
      if (n > 1) ++found_.nonmanifold_vertices;
    }
  }

  /// Triangles with the same corners share their smallest vertex: they are compared among its half-edges' triangles.
  void count_repeats() {
    std::vector<std::array<uint32_t, 2>> others;
    for (uint32_t v = 0; v < sides_.count(); ++v) {
      others.clear();
      for (const auto& [larger_end, half_edge] : sides_.in(v)) {
        // The one half-edge of the triangle that leaves its smallest corner.
        if (corner(half_edge) != v) continue;
        const uint32_t last = corner(next_in_triangle(next_in_triangle(half_edge)));
        if (last > v) others.push_back({std::min(larger_end, last), std::max(larger_end, last)});
      }
      std::sort(others.begin(), others.end());
      for (size_t i = 1; i < others.size(); ++i) found_.repeated_triangles += others[i] == others[i - 1];
    }
  }

  int64_t vertex_count_, edges_ = 0, referenced_ = 0;
  const Triangles& triangles_;
  const EdgeSides sides_;
  std::vector<uint32_t> fans_;
  MeshTopology found_;
};

MeshTopology check(const Triangles& triangles, int64_t vertex_count) {
  constexpr size_t kMaxTriangles = UINT32_MAX / 3;  // half-edges are numbered in 32 bits
  if (triangles.size() > kMaxTriangles)
    throw Error(ErrorCode::usage, "check",
                "the mesh has " + std::to_string(triangles.size()) + " triangles; at most " +
                    std::to_string(kMaxTriangles) + " can be numbered");
  require_indices(triangles, size_t(vertex_count), "check");
  const auto degenerate = std::count_if(triangles.begin(), triangles.end(), repeats_corner);
  if (degenerate == 0) return Checker(triangles, vertex_count).run(0);
  Triangles sound;
  std::copy_if(triangles.begin(), triangles.end(), std::back_inserter(sound),
               [](const auto& t) { return !repeats_corner(t); });
  return Checker(sound, vertex_count).run(degenerate);
}

}  // namespace

MeshTopology check_mesh(View<const TriangleIndices> triangles, int64_t vertex_count) {
  return check(list_of(triangles), vertex_count);
}

MeshTopology check_mesh(const TriangleMesh& mesh) { return check(mesh.triangles, int64_t(mesh.vertices.size())); }

}  // namespace isoshell
