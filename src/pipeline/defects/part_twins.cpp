// See part_twins.h.
#include "pipeline/defects/part_twins.h"

#include <algorithm>
#include <array>
#include <limits>
#include <unordered_map>

#include "isoshell/advanced/voxel_set.h"
#include "pipeline/defects/added_seeds.h"

namespace isoshell {
namespace {

uint64_t directed(uint32_t u, uint32_t v) { return uint64_t(u) << 32 | v; }

/// The mesh of patches while vertices are put in.
class Twins {
 public:
  Twins(const CutSurface& cut, const SeededMesh& made)
      : cut_(cut),
        made_(made),
        fixed_(made.seeds.fixed),
        added_(cut, made.seeds),
        is_home_(size_t(cut.surface.vertex_count()), 0) {
    for (const uint32_t v : made.seeds.home) is_home_[v] = 1;
    for (const TriangleIndices& t : made.mesh.triangles) add({t.a, t.b, t.c});
  }

  void part() {
    for (const auto& [u, v] : edges_there_twice()) part_edge(u, v);
    for (const auto& [first, second] : faces_there_twice())
      if (!part_face(second)) part_face(first);
  }

  bool has_changed() const { return !added_.empty(); }
  void give_to(SeededMesh& made) const {
    std::vector<TriangleIndices> triangles;
    for (const auto& [a, b, c] : triangles_) triangles.push_back({a, b, c});
    added_.give_to(made, triangles);
  }

 private:
  using Face = std::array<uint32_t, 3>;

  uint32_t joined(uint32_t v) const { return int64_t(v) < fixed_.joined.size() ? fixed_.joined[v] : v; }
  bool is_fixed(uint32_t v) const { return int64_t(v) < fixed_.count; }

  void add(const Face& face) {
    for (size_t i = 0; i < 3; ++i) side_[directed(face[i], face[(i + 1) % 3])] = uint32_t(triangles_.size());
    triangles_.push_back(face);
  }
  void replace(uint32_t triangle, const Face& face) {
    for (size_t i = 0; i < 3; ++i) side_[directed(face[i], face[(i + 1) % 3])] = triangle;
    triangles_[triangle] = face;
  }
  bool is_inside(uint32_t u, uint32_t v) const { return side_.count(directed(v, u)) > 0; }

  /// Those inside of patches, from their smaller ends.
  std::vector<std::array<uint32_t, 2>> edges_there_twice() const {
    struct Edge {
      uint64_t joined;
      bool is_inside;
      std::array<uint32_t, 2> end;
      bool operator<(const Edge& o) const {
        return joined != o.joined ? joined < o.joined : is_inside != o.is_inside ? !is_inside : end < o.end;
      }
    };
    std::vector<Edge> edges;
    for (const Face& t : triangles_)
      for (size_t i = 0; i < 3; ++i) {
        const uint32_t u = t[i], v = t[(i + 1) % 3];
        if (!is_fixed(u) || !is_fixed(v)) continue;
        const bool inside = is_inside(u, v);
        if (!inside || u < v) edges.push_back({edge_key(joined(u), joined(v)), inside, {u, v}});
      }
    std::sort(edges.begin(), edges.end());
    std::vector<std::array<uint32_t, 2>> out;
    for (size_t i = 1; i < edges.size(); ++i)
      if (edges[i].joined == edges[i - 1].joined && edges[i].is_inside) out.push_back(edges[i].end);
    return out;
  }

  std::vector<std::array<uint32_t, 2>> faces_there_twice() const {
    std::vector<std::pair<Face, uint32_t>> faces;
    for (uint32_t t = 0; t < triangles_.size(); ++t) {
      const auto& [a, b, c] = triangles_[t];
      if (!is_fixed(a) || !is_fixed(b) || !is_fixed(c)) continue;
      Face key{joined(a), joined(b), joined(c)};
      std::sort(key.begin(), key.end());
      faces.push_back({key, t});
    }
    std::sort(faces.begin(), faces.end());
    std::vector<std::array<uint32_t, 2>> out;
    for (size_t i = 1; i < faces.size(); ++i)
      if (faces[i].first == faces[i - 1].first) out.push_back({faces[i - 1].second, faces[i].second});
    return out;
  }

  /// A new vertex in a patch, nearest to a point; kNone where all vertices inside are taken.
  uint32_t vertex_near(uint32_t patch, const PointQ8& at) {
    const auto& of = cut_.surface.patch;
    const auto [begin, end] = std::equal_range(of.begin(), of.end(), patch);
    uint32_t nearest = kNone;
    int64_t least = std::numeric_limits<int64_t>::max();
    for (auto p = begin; p != end; ++p) {
      const auto v = uint32_t(p - of.begin());
      if (cut_.place[v] != kNone || is_home_[v]) continue;
      const int64_t d = distance_sq(cut_.surface.position[v], at);
      if (d < least) least = d, nearest = v;
    }
    if (nearest == kNone) return kNone;
    is_home_[nearest] = 1;
    return added_.add(nearest);
  }
  uint32_t patch_of(uint32_t vertex) const {
    return cut_.surface.patch[added_.holds(vertex) ? added_.home(vertex) : made_.seeds.home[vertex]];
  }
  const PointQ8& position_of(uint32_t vertex) const {
    return added_.holds(vertex) ? added_.position(vertex) : made_.mesh.position[vertex];
  }

  void part_edge(uint32_t u, uint32_t v) {
    const auto there = side_.find(directed(u, v)), back = side_.find(directed(v, u));
    if (there == side_.end() || back == side_.end()) return;
    const PointQ8 &p = position_of(u), &q = position_of(v);
    const uint32_t m = vertex_near(patch_of(u), {(p.x + q.x) / 2, (p.y + q.y) / 2, (p.z + q.z) / 2});
    if (m == kNone) return;
    const uint32_t one = there->second, other = back->second;
    side_.erase(directed(u, v));
    side_.erase(directed(v, u));
    part_triangle(one, u, v, m);
    part_triangle(other, v, u, m);
  }
  /// At its edge from u to v.
  void part_triangle(uint32_t triangle, uint32_t u, uint32_t v, uint32_t m) {
    Face face = triangles_[triangle];
    std::rotate(face.begin(), std::find(face.begin(), face.end(), u), face.end());
    const uint32_t w = face[2];
    replace(triangle, {u, m, w});
    add({m, v, w});
  }
  bool part_face(uint32_t triangle) {
    const auto [a, b, c] = triangles_[triangle];
    const PointQ8 &p = position_of(a), &q = position_of(b), &r = position_of(c);
    const uint32_t m = vertex_near(patch_of(a), {(p.x + q.x + r.x) / 3, (p.y + q.y + r.y) / 3, (p.z + q.z + r.z) / 3});
    if (m == kNone) return false;
    replace(triangle, {a, b, m});
    add({b, c, m});
    add({c, a, m});
    return true;
  }

  const CutSurface& cut_;
  const SeededMesh& made_;
  const FixedSeeds& fixed_;
  AddedSeeds added_;
  std::vector<char> is_home_;  ///< per vertex of the surface
  std::vector<Face> triangles_;
  std::unordered_map<uint64_t, uint32_t> side_;  ///< per directed edge its triangle
};

}  // namespace

void part_twins(const CutSurface& cut, SeededMesh& made) {
  Twins twins(cut, made);
  twins.part();
  if (!twins.has_changed()) return;
  twins.give_to(made);
}

}  // namespace isoshell
