// flip_flat_edges (see flip_flat_edges.h).
#include "features/flip_flat_edges.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/parallel_ranges.h"
#include "core/world_vector.h"
#include "features/edge_sides.h"
#include "features/split_edges.h"
#include "isoshell/voxel_set.h"
#include "voxel/union_find.h"

namespace isoshell {
namespace {

constexpr double kMostOffPlaneQ8 = 0.5;
constexpr size_t kMostFlipsPerEdge = 8;  ///< far more than it takes; rounding may not make it endless
constexpr double kRoundedAway = 1e-9;    ///< sums of two angles of 180 degrees, as in grids, are not told from it

/// Half-edge 3 t + i runs from corner i of triangle t to the next one. Of the triangles beside an edge, a to b, c is
/// the corner of the one that passes it so, d that of the other.
class FlatEdges {
 public:
  /// No edge is made that `avoided` has, which is ascending.
  FlatEdges(FineMesh& mesh, const std::vector<uint64_t>& avoided)
      : mesh_(mesh), avoided_(avoided), twin_(3 * mesh.triangles.size(), kNone) {
    for (const CurvePath& path : mesh.paths)
      for (size_t i = 0; i < path.edge_count(); ++i) on_path_.push_back(edge_key(path.vertex[i], path.edge_end(i)));
    std::sort(on_path_.begin(), on_path_.end());
    find_twins();
  }

  void flip_all() {
    std::vector<uint8_t> is_waiting(twin_.size(), 0);
    for_each_index(uint32_t(0), uint32_t(twin_.size()),
                   [&](uint32_t h) { is_waiting[h] = twin_[h] != kNone && h == canonical(h) && should_flip(h); });
    std::vector<uint32_t> waiting;
    for (uint32_t h = 0; h < is_waiting.size(); ++h)
      if (is_waiting[h]) waiting.push_back(h);
    const std::vector<uint32_t> part = parts();
    tbb::parallel_sort(waiting.begin(), waiting.end(), [&](uint32_t g, uint32_t h) {
      if (part[g / 3] != part[h / 3]) return part[g / 3] < part[h / 3];
      if (is_before(at(from(g)), at(from(h)))) return true;
      if (is_before(at(from(h)), at(from(g)))) return false;
      if (is_before(at(to(g)), at(to(h)))) return true;
      return !is_before(at(to(h)), at(to(g))) && g < h;
    });
    std::vector<std::vector<uint32_t>> of_part;
    for (size_t i = 0; i < waiting.size(); ++i) {
      if (i == 0 || part[waiting[i] / 3] != part[waiting[i - 1] / 3]) of_part.emplace_back();
      of_part.back().push_back(waiting[i]);
    }
    for_each_index(size_t(0), of_part.size(), [&](size_t p) { flip_waiting(std::move(of_part[p])); });
  }

 private:
  /// Per triangle what it hangs together with over edges that may flip: of no flip more is seen or changed.
  std::vector<uint32_t> parts() const {
    std::vector<uint32_t> part(mesh_.triangles.size());
    const View<uint32_t> sets{part.data(), int64_t(part.size())};
    for_each_index(int64_t(0), sets.size, StartAlone{sets});
    for_each_index(uint32_t(0), uint32_t(twin_.size()), [&](uint32_t h) {
      if (twin_[h] != kNone) join(sets, h / 3, twin_[h] / 3);
    });
    for_each_index(int64_t(0), sets.size, PointAtRoot{sets});
    return part;
  }

  void flip_waiting(std::vector<uint32_t> waiting) {
    for (size_t left = kMostFlipsPerEdge * twin_.size(); !waiting.empty() && left > 0; --left) {
      uint32_t h = waiting.back();
      waiting.pop_back();
      if (twin_[h] == kNone) continue;
      h = canonical(h);
      if (!should_flip(h)) continue;
      const uint32_t t = h - h % 3, u = twin_[h] - twin_[h] % 3;
      flip(h);
      waiting.insert(waiting.end(), {t, t + 2, u, u + 2});
    }
  }

  static uint32_t next(uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
  uint32_t from(uint32_t h) const { return mesh_.triangles[h / 3][h % 3]; }
  uint32_t to(uint32_t h) const { return from(next(h)); }
  uint32_t opposite(uint32_t h) const { return from(next(next(h))); }
  const WorldPoint& at(uint32_t v) const { return mesh_.position[v]; }
  uint32_t canonical(uint32_t h) const { return is_before(at(from(h)), at(to(h))) ? h : twin_[h]; }

  /// Where the two triangles of an edge pass it in opposite directions, and no path does.
  void find_twins() {
    std::vector<uint8_t> is_on_path(mesh_.position.size(), 0);
    for (const CurvePath& path : mesh_.paths)
      for (const uint32_t v : path.vertex) is_on_path[v] = 1;
    const EdgeSides sides = find_edge_sides(mesh_.triangles, mesh_.position.size());
    for_each_index(uint32_t(0), uint32_t(mesh_.position.size()), [&](uint32_t u) {
      for_each_edge_from(sides, u, [&](uint32_t v, View<const EdgeSide> on_edge) {
        const uint32_t g = on_edge[0].half_edge, h = on_edge[on_edge.size - 1].half_edge;
        if (on_edge.size != 2 || from(g) != to(h)) return;
        if (is_on_path[u] && is_on_path[v] && std::binary_search(on_path_.begin(), on_path_.end(), edge_key(u, v)))
          return;
        twin_[g] = h;
        twin_[h] = g;
      });
    });
  }

  /// Whether the angles at c and d are more than 180 degrees together, and the edge between them would do as well and
  /// be the only one.
  bool should_flip(uint32_t h) const {
    const WorldPoint &a = at(from(h)), &b = at(to(h)), &c = at(opposite(h)), &d = at(opposite(twin_[h]));
    const WorldPoint at_c = cross(b - a, c - a), at_d = cross(a - b, d - b);
    const double area_c = length(at_c), area_d = length(at_d), ab = length(b - a);
    const double left = dot(a - c, b - c) * area_d, right = dot(a - d, b - d) * area_c;
    if (left + right >= -kRoundedAway * (std::abs(left) + std::abs(right))) return false;
    const WorldPoint both = {at_c.x + at_d.x, at_c.y + at_d.y, at_c.z + at_d.z};
    if (std::abs(dot(at_c, d - a)) > kMostOffPlaneQ8 * length(both)) return false;
    const auto faces_so = [&](const WorldPoint& n, double area) {
      return dot(n, both) > 0 || area <= kMostOffPlaneQ8 * ab;
    };
    if (!faces_so(at_c, area_c) || !faces_so(at_d, area_d)) return false;
    if (dot(cross(d - a, c - a), both) <= 0 || dot(cross(c - b, d - b), both) <= 0) return false;
    return length(d - c) <= std::max({ab, length(c - a), length(c - b), length(d - a), length(d - b)}) &&
           !is_beside(next(next(h)), opposite(twin_[h])) &&
           !std::binary_search(avoided_.begin(), avoided_.end(), edge_key(opposite(h), opposite(twin_[h])));
  }

  /// Whether an edge joins the vertex that a half-edge begins at to another one, in the fan of its triangle.
  bool is_beside(uint32_t begin, uint32_t other) const {
    for (uint32_t h = begin; h != kNone;) {
      const uint32_t before = next(next(h));
      if (to(h) == other || from(before) == other) return true;
      h = twin_[before];
      if (h == begin) return false;
    }
    for (uint32_t h = twin_[begin]; h != kNone; h = twin_[next(h)])
      if (to(next(h)) == other || opposite(next(h)) == other) return true;
    return false;
  }

  /// The triangles a, b, c and b, a, d become a, d, c and b, c, d.
  void flip(uint32_t h) {
    const uint32_t g = twin_[h], t = h - h % 3, u = g - g % 3;
    const uint32_t a = from(h), b = to(h), c = opposite(h), d = opposite(g);
    const uint32_t at_ad = twin_[next(g)], at_ca = twin_[next(next(h))], at_bc = twin_[next(h)],
                   at_db = twin_[next(next(g))];
    mesh_.triangles[t / 3] = {a, d, c};
    mesh_.triangles[u / 3] = {b, c, d};
    connect(t, at_ad);
    connect(t + 1, u + 1);
    connect(t + 2, at_ca);
    connect(u, at_bc);
    connect(u + 2, at_db);
  }
  void connect(uint32_t g, uint32_t h) {
    twin_[g] = h;
    if (h != kNone) twin_[h] = g;
  }

  FineMesh& mesh_;
  const std::vector<uint64_t>& avoided_;
  std::vector<uint32_t> twin_;  ///< kNone where an edge stays
  std::vector<uint64_t> on_path_;
};

/// Edges of more than two triangles, ascending.
std::vector<uint64_t> crowded_edges(const MeshTriangles& triangles, size_t vertices) {
  const EdgeSides sides = find_edge_sides(triangles, vertices);
  std::vector<uint8_t> begins(vertices, 0);
  for_each_index(size_t(0), vertices, [&](size_t u) {
    for_each_edge_from(sides, int64_t(u),
                       [&](uint32_t, View<const EdgeSide> on_edge) { begins[u] |= on_edge.size > 2; });
  });
  std::vector<uint64_t> edges;
  for (size_t u = 0; u < vertices; ++u)
    if (begins[u])
      for_each_edge_from(sides, int64_t(u), [&](uint32_t v, View<const EdgeSide> on_edge) {
        if (on_edge.size > 2) edges.push_back(edge_key(uint32_t(u), v));
      });
  return edges;
}

/// Adds to `made` the crowded edges that flips made. Whether there are any.
bool add_crowded(const FineMesh& mesh, const MeshTriangles& before, std::vector<uint64_t>& made) {
  const std::vector<uint64_t> now = crowded_edges(mesh.triangles, mesh.position.size());
  if (now.empty()) return false;
  const std::vector<uint64_t> then = crowded_edges(before, mesh.position.size());
  const size_t known = made.size();
  std::set_difference(now.begin(), now.end(), then.begin(), then.end(), std::back_inserter(made));
  std::sort(made.begin(), made.end());
  return made.size() > known;
}

}  // namespace

FineMesh flip_flat_edges(FineMesh mesh) {
  const MeshTriangles before = mesh.triangles;
  std::vector<uint64_t> crowded;  // what both sides of a thin part would make
  for (;;) {
    FlatEdges(mesh, crowded).flip_all();
    if (!add_crowded(mesh, before, crowded)) return mesh;
    mesh.triangles = before;
  }
}

}  // namespace isoshell
