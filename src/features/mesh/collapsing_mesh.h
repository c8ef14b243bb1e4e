// Triangles whose vertices go into their neighbours until edges are long enough: what is common to all of that.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "geometry/half_edges.h"
#include "isoshell/advanced/voxel_set.h"

namespace isoshell {

/// `Surface`, which this is the base of, knows where vertices are: squared distances distance_sq(u, v), of type Square,
/// and squares of lengths in terms of the edge aimed at, square_of(edges, v); the longest edge that it lets become,
/// kLongest, in these terms; which vertices others may go into, may_take(v); what becomes of a triangle, fits(corner,
/// into), once its corner is another vertex; and how a vertex goes where may_go allows it, go(v, into, scratch). Corner
/// 3 t + i is that at place i of triangle t. Several threads may take in vertices at once that have no neighbours in
/// common.
template <class Surface, class Square>
class CollapsingMesh {
 public:
  using Ring = std::vector<uint32_t>;  ///< neighbours of a vertex, ascending

 protected:
  static constexpr int kMostSweeps =
      8;  ///< each with vertices none of which are neighbours, so that what is left is even

  struct Scratch {
    Ring ring, other;
    std::vector<std::pair<Square, uint32_t>> choice;
  };

  CollapsingMesh(std::vector<std::array<uint32_t, 3>> triangles, size_t vertices)
      : triangles_(std::move(triangles)),
        may_change_(vertices, 1),
        stays_(vertices, 0),
        next_(3 * triangles_.size(), kNone),
        first_(vertices, kNone),
        last_(vertices, kNone) {
    for (uint32_t c = 0; c < next_.size(); ++c) append(corner(c), c, c);
  }

  uint32_t vertices() const { return uint32_t(first_.size()); }
  uint32_t corner(uint32_t c) const { return triangles_[c / 3][c % 3]; }
  bool is_there(uint32_t v) const { return first_[v] != kNone; }
  bool has(uint32_t c, uint32_t v) const {
    const auto& t = triangles_[c / 3];
    return t[0] == v || t[1] == v || t[2] == v;
  }
  /// Calls visit(corner) for the corners that a vertex has.
  template <class Visit>
  void for_each_corner(uint32_t v, Visit visit) const {
    for (uint32_t c = first_[v]; c != kNone; c = next_[c])
      if (corner(c) != kNone) visit(c);
  }
  void find_ring(uint32_t v, Ring& ring) const {
    ring.clear();
    for_each_corner(v, [&](uint32_t c) {
      const uint32_t a = next_in_triangle(c);
      ring.insert(ring.end(), {corner(a), corner(next_in_triangle(a))});
    });
    std::sort(ring.begin(), ring.end());
    ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
  }

  /// Whether a vertex may go into a neighbour: the topology stays, triangles stay short and fit. Lists the neighbours
  /// of that in `other`.
  bool may_go(uint32_t v, const Ring& ring, uint32_t into, Ring& other) const {
    const Square most_sq = self().square_of(Surface::kLongest, into);
    if (std::any_of(ring.begin(), ring.end(), [&](uint32_t w) { return self().distance_sq(w, into) > most_sq; }))
      return false;
    find_ring(into, other);
    ptrdiff_t on_edge = 0;
    bool is_right = true;
    for_each_corner(v, [&](uint32_t c) {
      if (has(c, into))
        ++on_edge;
      else
        is_right = is_right && self().fits(c, into, other);
    });
    const auto is_shared = [&](uint32_t w) { return std::binary_search(other.begin(), other.end(), w); };
    return is_right && std::count_if(ring.begin(), ring.end(), is_shared) == on_edge;
  }
  /// Into the neighbour that leaves the shortest edges, of equal ones the first, where the vertex has a short edge.
  template <class S>
  bool thin_inside(uint32_t v, S& s) {
    const Square least_sq = self().square_of(kShort, v);
    const auto is_short = [&](uint32_t w) { return self().distance_sq(v, w) < least_sq; };
    if (s.ring.size() > kMostNeighbours || std::none_of(s.ring.begin(), s.ring.end(), is_short)) return false;
    s.choice.clear();
    for (const uint32_t u : s.ring) {
      if (!self().may_take(u)) continue;
      Square longest_sq = 0;
      for (const uint32_t w : s.ring) longest_sq = std::max(longest_sq, self().distance_sq(u, w));
      s.choice.push_back({longest_sq, u});
    }
    std::sort(s.choice.begin(), s.choice.end());
    return std::any_of(s.choice.begin(), s.choice.end(), [&](const auto& choice) {
      return may_go(v, s.ring, choice.second, s.other) && self().go(v, choice.second, s);
    });
  }
  void take_into(uint32_t v, const Ring& ring, uint32_t into) {
    for_each_corner(v, [&](uint32_t c) {
      if (has(c, into))
        triangles_[c / 3].fill(kNone);
      else
        triangles_[c / 3][c % 3] = into;
    });
    append(into, first_[v], last_[v]);
    first_[v] = kNone;
    for (const uint32_t w : ring) stays_[w] = may_change_[w] = 1;
  }

  std::vector<std::array<uint32_t, 3>> triangles_;  ///< one that is gone has no corners
  std::vector<char> may_change_;                    ///< per vertex: something has changed since it could not go
  std::vector<char> stays_;                         ///< per vertex: for a sweep

 private:
  static constexpr double kShort = 0.2;          ///< edges aimed at: off curves, a vertex with a shorter one goes
  static constexpr size_t kMostNeighbours = 16;  ///< of a vertex that goes

  const Surface& self() const { return static_cast<const Surface&>(*this); }
  Surface& self() { return static_cast<Surface&>(*this); }
  void append(uint32_t vertex, uint32_t first, uint32_t last) {
    (first_[vertex] == kNone ? first_[vertex] : next_[last_[vertex]]) = first;
    last_[vertex] = last;
  }

  std::vector<uint32_t> next_;  ///< per corner the next one of its vertex, those of triangles that are gone, too
  std::vector<uint32_t> first_, last_;  ///< per vertex; none: it is gone
};

}  // namespace isoshell
