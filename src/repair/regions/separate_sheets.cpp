// See separate_sheets.h.
#include "repair/regions/separate_sheets.h"

#include <algorithm>

#include "core/index_sets.h"
#include "geometry/half_edges.h"
#include "geometry/world_vector.h"
#include "measure/around_edge.h"

namespace isoshell::repair {
namespace {

using Corners = std::array<uint32_t, 3>;

class Separation {
 public:
  Separation(double gap_world, std::vector<WorldPoint>& point, std::vector<Corners>& face,
             std::vector<uint32_t>& source)
      : gap_world_(gap_world), point_(point), face_(face), source_(source) {}

  /// Edges both ends of which two sheets have in common are divided at their middles, and vertices copied. Each look
  /// divides an edge, and no edge is divided twice.
  int64_t run() {
    if (!find_pairs()) return 0;
    const int64_t edges = int64_t(shared_.size());
    while (divide_shared()) find_pairs();
    copy_vertices();
    return edges;
  }

 private:
  struct SharedEdge {
    uint32_t u, v;
    std::vector<std::array<uint32_t, 2>> pairs;  ///< half-edges of faces with solid between them
  };

  /// Corners, as half-edges that begin there, that are of one sheet. Result: whether any edge has more than two faces.
  bool find_pairs() {
    shared_.clear();
    fans_ = IndexSets(3 * int64_t(face_.size()));
    is_at_shared_.assign(point_.size(), 0);
    const EdgeSides edges = find_edge_sides(face_, point_.size());
    for_each_edge(edges, [&](uint32_t u, uint32_t v, View<const EdgeSide> sides) {
      if (sides.size == 2) join(sides[0].half_edge, sides[1].half_edge);
      if (sides.size <= 2) return;
      shared_.push_back({u, v, pairs_at(u, v, sides)});
      is_at_shared_[u] = is_at_shared_[v] = 1;
      for (const auto& [h, k] : shared_.back().pairs) join(h, k);
    });
    return !shared_.empty();
  }

  std::vector<std::array<uint32_t, 2>> pairs_at(uint32_t u, uint32_t v, View<const EdgeSide> sides) const {
    std::vector<TriangleAtEdge> around = triangles_at_edge(face_, u, sides);
    sort_around_edge(point_, u, v, around);
    const auto half_edge = [&](const TriangleAtEdge& t) {
      return std::find_if(sides.begin(), sides.end(), [&](const EdgeSide& s) { return s.half_edge / 3 == t.triangle; })
          ->half_edge;
    };
    std::vector<std::array<uint32_t, 2>> pairs;
    for (size_t i = 0; i < around.size(); ++i) {
      const TriangleAtEdge &here = around[i], &next = around[(i + 1) % around.size()];
      if (!here.rises && next.rises) pairs.push_back({half_edge(here), half_edge(next)});
    }
    return pairs;
  }

  /// Two half-edges of one edge, in opposite directions.
  void join(uint32_t h, uint32_t k) {
    fans_.unite(h, next_in_triangle(k));
    fans_.unite(next_in_triangle(h), k);
  }

  std::array<uint32_t, 2> fans_of(uint32_t half_edge, uint32_t u) {
    const uint32_t here = fans_.root(half_edge), next = fans_.root(next_in_triangle(half_edge));
    return face_[half_edge / 3][half_edge % 3] == u ? std::array{here, next} : std::array{next, here};
  }

  /// At the middle of edges of which two pairs would be one again, of each face one edge at a time. Result: whether
  /// any.
  bool divide_shared() {
    bool is_any = false;
    std::vector<uint8_t> is_divided(face_.size(), 0);
    for (const SharedEdge& e : shared_) {
      std::vector<std::array<uint32_t, 2>> fans;
      for (const auto& pair : e.pairs) fans.push_back(fans_of(pair[0], e.u));
      std::sort(fans.begin(), fans.end());
      if (std::adjacent_find(fans.begin(), fans.end()) == fans.end()) continue;
      const bool is_possible = std::none_of(e.pairs.begin(), e.pairs.end(), [&](const auto& pair) {
        return is_divided[pair[0] / 3] || is_divided[pair[1] / 3];
      });
      if (!is_possible) continue;
      is_any = true;
      const uint32_t middle = uint32_t(point_.size());
      point_.push_back(.5 * (point_[e.u] + point_[e.v]));
      for (const auto& pair : e.pairs)
        for (const uint32_t h : pair) {
          is_divided[h / 3] = 1;
          divide(h, middle);
        }
    }
    return is_any;
  }

  void divide(uint32_t half_edge, uint32_t middle) {
    Corners& corner = face_[half_edge / 3];
    Corners other = corner;
    corner[next_in_triangle(half_edge) % 3] = middle;
    other[half_edge % 3] = middle;
    face_.push_back(other);
    source_.push_back(source_[half_edge / 3]);
  }

  void copy_vertices() {
    std::vector<WorldPoint> normal(3 * face_.size(), {0, 0, 0});
    for (uint32_t h = 0; h < 3 * face_.size(); ++h) {
      if (!is_at_shared_[face_[h / 3][h % 3]]) continue;
      const auto& [a, b, c] = face_[h / 3];
      WorldPoint& sum = normal[fans_.root(h)];
      sum = sum + normalised(doubled_area(point_[a], point_[b], point_[c]));
    }
    const std::vector<Corners> before = face_;
    std::vector<uint32_t> fans(point_.size(), 0), number(3 * face_.size(), 0);
    for (uint32_t h = 0; h < 3 * before.size(); ++h) fans[before[h / 3][h % 3]] += fans_.root(h) == h;
    for (uint32_t h = 0; h < 3 * before.size(); ++h) {
      const uint32_t v = before[h / 3][h % 3], root = fans_.root(h);
      if (!is_at_shared_[v] || fans[v] < 2) continue;
      if (root == h) {
        number[h] = uint32_t(point_.size());
        point_.push_back(point_[v] - gap_world_ * normalised(normal[h]));
      }
      face_[h / 3][h % 3] = number[root];
    }
  }

  const double gap_world_;
  std::vector<WorldPoint>& point_;
  std::vector<Corners>& face_;
  std::vector<uint32_t>& source_;
  std::vector<SharedEdge> shared_;
  IndexSets fans_{0};
  std::vector<uint8_t> is_at_shared_;  ///< per point
};

}  // namespace

int64_t separate_sheets(double gap_world, std::vector<WorldPoint>& point, std::vector<std::array<uint32_t, 3>>& face,
                        std::vector<uint32_t>& source) {
  return Separation(gap_world, point, face, source).run();
}

}  // namespace isoshell::repair
