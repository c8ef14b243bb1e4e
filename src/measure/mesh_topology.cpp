// check_mesh: half-edges are gathered at their smaller end, sorted there, and matched.
#include "isoshell/mesh_topology.h"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "core/half_edge_list.h"
#include "isoshell/error.h"
#include "measure/index_sets.h"

namespace isoshell {
namespace {

/// A half-edge at its smaller end. Half-edge 3 t + i runs from corner i of triangle t to the next one.
struct HalfEdge {
  uint32_t larger_end;
  uint32_t number;
  bool rises;  ///< runs from the smaller to the larger end
};

class Checker {
 public:
  Checker(View<const TriangleIndices> triangles, int64_t vertex_count) : vertex_count_(vertex_count) {
    constexpr int64_t kMaxTriangles = UINT32_MAX / 3;  // half-edges are numbered in 32 bits
    if (triangles.size > kMaxTriangles)
      throw Error(ErrorCode::usage, "check",
                  "the mesh has " + std::to_string(triangles.size) + " triangles; at most " +
                      std::to_string(kMaxTriangles) + " can be numbered");
    corners_.reserve(size_t(triangles.size) * 3);
    for (const TriangleIndices& t : triangles) {
      for (uint32_t v : {t.a, t.b, t.c})
        if (v >= vertex_count)
          throw Error(ErrorCode::usage, "check",
                      "a triangle names vertex " + std::to_string(v) + "; there are " + std::to_string(vertex_count));
      if (t.a == t.b || t.b == t.c || t.c == t.a)
        ++found_.degenerate_triangles;
      else
        corners_.insert(corners_.end(), {t.a, t.b, t.c});
    }
  }

  MeshTopology run() {
    gather_half_edges();
    match_half_edges();
    count_vertices();
    count_repeats();
    found_.euler = referenced_ - edges_ + int64_t(corners_.size() / 3);
    found_.closed = !corners_.empty() && found_.boundary_edges == 0;
    found_.manifold = found_.nonmanifold_edges == 0 && found_.nonmanifold_vertices == 0 &&
                      found_.repeated_triangles == 0 && found_.degenerate_triangles == 0;
    if (found_.manifold) found_.genus = (2 * found_.components - found_.boundary_loops - found_.euler) / 2;
    return found_;
  }

 private:
  void gather_half_edges() {
    first_.assign(size_t(vertex_count_) + 1, 0);
    for (uint32_t h = 0; h < corners_.size(); ++h) ++first_[std::min(corners_[h], corners_[next_in_triangle(h)])];
    int64_t end = 0;
    for (int64_t& f : first_) f = end += f;
    half_edges_.resize(corners_.size());
    for (uint32_t h = uint32_t(corners_.size()); h-- > 0;) {
      const uint32_t from = corners_[h], to = corners_[next_in_triangle(h)];
      half_edges_[size_t(--first_[std::min(from, to)])] = {std::max(from, to), h, from < to};
    }
  }

  /// Joins corners around their vertex through edges with two faces, vertices through all edges.
  void match_half_edges() {
    IndexSets fans(int64_t(corners_.size())), vertices(vertex_count_);
    std::vector<uint32_t> boundary;
    for (uint32_t v = 0; v < vertex_count_; ++v) {
      HalfEdge* const begin = half_edges_.data() + first_[v];
      HalfEdge* const end = half_edges_.data() + first_[v + 1];
      std::sort(begin, end, [](const HalfEdge& a, const HalfEdge& b) {
        return a.larger_end != b.larger_end ? a.larger_end < b.larger_end : a.number < b.number;
      });
      for (HalfEdge* run = begin; run != end;) {
        HalfEdge* stop = run;
        while (stop != end && stop->larger_end == run->larger_end) ++stop;
        ++edges_;
        vertices.unite(v, run->larger_end);
        if (stop - run == 1)
          boundary.push_back(run->number);
        else if (stop - run > 2 || run[0].rises == run[1].rises)
          ++found_.nonmanifold_edges;
        else {
          fans.unite(run[0].number, next_in_triangle(run[1].number));
          fans.unite(next_in_triangle(run[0].number), run[1].number);
        }
        run = stop;
      }
    }
    found_.boundary_edges = int64_t(boundary.size());
    count_fans(fans, vertices);
    count_loops(fans, boundary);
  }

  void count_fans(IndexSets& fans, IndexSets& vertices) {
    fans_.assign(size_t(vertex_count_), 0);
    for (uint32_t h = 0; h < corners_.size(); ++h)
      if (fans.root(h) == h) ++fans_[corners_[h]];
    for (uint32_t v = 0; v < vertex_count_; ++v)
      if (fans_[v] > 0 && vertices.root(v) == v) ++found_.components;
  }

  /// Boundary edges that end in one fan belong to one loop.
  void count_loops(IndexSets& fans, const std::vector<uint32_t>& boundary) {
    if (boundary.empty()) return;
    IndexSets loops(int64_t(corners_.size()));
    std::vector<uint32_t> ends;
    for (uint32_t h : boundary) {
      const uint32_t from = fans.root(h), to = fans.root(next_in_triangle(h));
      loops.unite(from, to);
      ends.insert(ends.end(), {from, to});
    }
    std::sort(ends.begin(), ends.end());
    ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
    for (uint32_t e : ends)
      if (loops.root(e) == e) ++found_.boundary_loops;
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
    for (uint32_t v = 0; v < vertex_count_; ++v) {
      others.clear();
      for (int64_t i = first_[v]; i < first_[v + 1]; ++i) {
        // The one half-edge of the triangle that leaves its smallest corner.
        const HalfEdge& e = half_edges_[size_t(i)];
        if (!e.rises) continue;
        const uint32_t last = corners_[next_in_triangle(next_in_triangle(e.number))];
        if (last > v) others.push_back({std::min(e.larger_end, last), std::max(e.larger_end, last)});
      }
      std::sort(others.begin(), others.end());
      for (size_t i = 1; i < others.size(); ++i) found_.repeated_triangles += others[i] == others[i - 1];
    }
  }

  int64_t vertex_count_, edges_ = 0, referenced_ = 0;
  std::vector<uint32_t> corners_;
  std::vector<int64_t> first_;
  std::vector<HalfEdge> half_edges_;
  std::vector<uint32_t> fans_;
  MeshTopology found_;
};

}  // namespace

MeshTopology check_mesh(View<const TriangleIndices> triangles, int64_t vertex_count) {
  return Checker(triangles, vertex_count).run();
}

MeshTopology check_mesh(const TriangleMesh& mesh) {
  Buffer<TriangleIndices> triangles{int64_t(mesh.triangles.size())};
  for (int64_t i = 0; i < triangles.size(); ++i) {
    const auto& t = mesh.triangles[size_t(i)];
    triangles[i] = {t[0], t[1], t[2]};
  }
  return check_mesh(triangles.view(), int64_t(mesh.vertices.size()));
}

}  // namespace isoshell
