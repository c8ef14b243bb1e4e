// See open_mesh.h.
#include "features/walls/open_mesh.h"

#include <algorithm>
#include <utility>

#include "features/walls/curve_edges.h"
#include "geometry/half_edges.h"

namespace isoshell {
namespace {

bool is_free(const RegionVertex& v) { return v.kind == RegionVertex::Kind::free; }

/// The edges that are on curves; keys, ascending.
CurveEdges curve_edges_of(const EditableMesh& mesh) {
  CurveEdges edges;
  for (const RegionTriangle& t : mesh.triangles())
    for (size_t i = 0; i < 3 && !t.is_gone(); ++i)
      if (t.curve[i] != kNone) edges.push_back({edge_key(t.corner[i], t.corner[(i + 1) % 3]), t.curve[i]});
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

/// Copies of the vertices of triangles, which are numbered as they come.
class Copies {
 public:
  explicit Copies(const EditableMesh& mesh) : mesh_(mesh), copy_(3 * mesh.triangles().size(), kNone) {}

  /// Gives the triangles around a vertex in which one comes from another without crossing a curve the same copy, from
  /// `next` on. Result: one triangle of each.
  std::vector<uint32_t> number(uint32_t v, uint32_t next) {
    std::vector<uint32_t> first;
    mesh_.for_each_around(v, [&](uint32_t t) {
      if (copy_[corner(t, v)] != kNone) return;
      first.push_back(t);
      waiting_.push_back(t);
      while (!waiting_.empty()) {
        const uint32_t here = waiting_.back();
        waiting_.pop_back();
        copy_[corner(here, v)] = next;
        add_neighbours(v, here);
      }
      ++next;
    });
    return first;
  }
  uint32_t at(size_t t, size_t i) const { return copy_[3 * t + i]; }

 private:
  size_t corner(uint32_t t, uint32_t v) const {
    const auto& c = mesh_.triangles()[t].corner;
    return 3 * size_t(t) + (c[0] == v ? 0 : c[1] == v ? 1 : 2);
  }
  /// Those that share an edge at the vertex with a triangle that is on no curve.
  void add_neighbours(uint32_t v, uint32_t t) {
    const RegionTriangle& here = mesh_.triangles()[t];
    const size_t i = corner(t, v) - 3 * size_t(t);
    for (const size_t edge : {i, (i + 2) % 3}) {
      if (here.curve[edge] != kNone) continue;
      const uint32_t w = here.corner[edge == i ? (i + 1) % 3 : edge];
      mesh_.for_each_around(v, [&](uint32_t other) {
        if (mesh_.triangles()[other].has(w) && copy_[corner(other, v)] == kNone) waiting_.push_back(other);
      });
    }
  }

  const EditableMesh& mesh_;
  std::vector<uint32_t> copy_;  ///< per corner of a triangle
  std::vector<uint32_t> waiting_;
};

}  // namespace

OpenMesh::OpenMesh(const EditableMesh& joined, const CutLookup& lookup) : joined_(joined) {
  Copies copies(joined);
  std::vector<uint32_t> home, first_copy;
  const auto add_vertices = [&](bool are_free) {
    for (uint32_t v = 0; v < joined.vertices().size(); ++v) {
      if (joined.around(v).empty() || is_free(joined.vertex(v)) != are_free) continue;
      const auto first = uint32_t(of_joined_.size());
      for (const uint32_t t : copies.number(v, first)) {
        of_joined_.push_back(v);
        patch_.push_back(joined.triangles()[t].patch);
        first_copy.push_back(first);
        const uint32_t copy = lookup.copy_in(joined.vertex(v).home, patch_.back());
        home.push_back(copy != kNone ? copy : joined.vertex(v).home);  // patches may touch at a point
      }
    }
  };
  add_vertices(false);
  const auto fixed = int64_t(of_joined_.size());
  add_vertices(true);
  const auto count = int64_t(of_joined_.size());
  made_.mesh.position = Buffer<PointQ8>(count);
  made_.seeds.position = Buffer<PointQ8>(count);
  made_.seeds.normal = Buffer<Normal8>(count);
  made_.seeds.home = Buffer<uint32_t>(count);
  for (int64_t i = 0; i < count; ++i) {
    made_.mesh.position[i] = made_.seeds.position[i] = rounded_down(joined.at(of_joined_[size_t(i)]));
    made_.seeds.home[i] = home[size_t(i)];
    made_.seeds.normal[i] = lookup.cut().surface.normal[home[size_t(i)]];
  }
  made_.seeds.fixed.count = fixed;
  made_.seeds.fixed.joined = Buffer<uint32_t>(fixed);
  std::copy(first_copy.begin(), first_copy.begin() + fixed, made_.seeds.fixed.joined.begin());
  made_.seeds.fixed.of_vertex = Buffer<uint32_t>(fixed > 0 ? lookup.cut().surface.vertex_count() : 0);
  std::fill(made_.seeds.fixed.of_vertex.begin(), made_.seeds.fixed.of_vertex.end(), kNone);
  for (int64_t i = 0; i < fixed; ++i) made_.seeds.fixed.of_vertex[home[size_t(i)]] = uint32_t(i);
  std::vector<TriangleIndices> triangles;
  for (size_t t = 0; t < joined.triangles().size(); ++t)
    if (!joined.triangles()[t].is_gone()) triangles.push_back({copies.at(t, 0), copies.at(t, 1), copies.at(t, 2)});
  made_.mesh.triangles = Buffer<TriangleIndices>(int64_t(triangles.size()));
  std::copy(triangles.begin(), triangles.end(), made_.mesh.triangles.begin());
}

EditableMesh OpenMesh::joined_again(const SeededMesh& optimized) const {
  std::vector<RegionVertex> vertices = joined_.vertices();
  for (int64_t i = optimized.seeds.fixed.count; i < optimized.seeds.size(); ++i) {
    RegionVertex& v = vertices[of_joined_[size_t(i)]];
    const PointQ8 p = optimized.mesh.position[i];
    v.home = optimized.seeds.home[i];
    v.position = {double(p.x), double(p.y), double(p.z)};
  }
  const CurveEdges curves = curve_edges_of(joined_);
  std::vector<RegionTriangle> triangles;
  for (const TriangleIndices& t : optimized.mesh.triangles) {
    const uint32_t a = of_joined_[t.a], b = of_joined_[t.b], c = of_joined_[t.c];
    triangles.push_back(
        {{a, b, c}, {curve_of(curves, a, b), curve_of(curves, b, c), curve_of(curves, c, a)}, patch_[t.a]});
  }
  return {std::move(vertices), std::move(triangles), EditableMesh::Size::many};
}

}  // namespace isoshell
