// The dual on surfaces with borders: what fixed seeds hold there, and edges between them that would be one edge of the
// result where patches are joined.
#pragma once

#include <string>

#include "isoshell/error.h"
#include "stages/dual/dual_faces_body.h"

namespace isoshell::dual {

/// The borders of a surface as its fixed seeds share them.
struct FixedBorder {
  Buffer<uint32_t> vertex;  ///< all border vertices, ascending
  Buffer<uint32_t> held;    ///< per fixed seed how many of them are its
  Buffer<uint32_t> next;    ///< per fixed seed the next one along its border
};

struct IsOnBorder {
  View<const uint32_t> before;
  ISOSHELL_HD bool operator()(int64_t v) const { return before[v] != kNone; }
};
/// Border vertices that are nobody's, and others that are somebody's.
struct IsWronglyHeld {
  View<const uint32_t> before, of_vertex;
  int64_t fixed;
  ISOSHELL_HD int64_t operator()(int64_t v) const {
    return (before[v] != kNone) != (int64_t(of_vertex[v]) < fixed) ? 1 : 0;
  }
};
struct FollowBorder {
  View<const uint32_t> vertex, before, of_vertex;
  View<uint32_t> held, runs, next;
  ISOSHELL_HD void operator()(int64_t i) const {
    const uint32_t mine = of_vertex[vertex[i]], last = of_vertex[before[vertex[i]]];
    atomic_add(held[mine], 1u);
    if (mine == last) return;
    atomic_add(runs[mine], 1u);
    atomic_min(next[last], mine);
  }
};
struct IsMisplaced {
  View<const uint32_t> runs, next;
  ISOSHELL_HD int64_t operator()(int64_t s) const {
    return runs[s] != 1 || next[s] == kNone || next[next[s]] == uint32_t(s) ? 1 : 0;
  }
};

/// Throws usage unless every border has three fixed seeds or more, and each of them its vertices in one run.
template <class Exec>
FixedBorder follow_borders(Exec& exec, const SurfaceMesh& surface, const FixedSeeds& fixed) {
  const View<const uint32_t> before = surface.border_before.view(), of_vertex = fixed.of_vertex.view();
  const int64_t wrong = exec.sum(surface.vertex_count(), IsWronglyHeld{before, of_vertex, fixed.count});
  if (wrong > 0)
    throw NoRoom("dual", "fixed.of_vertex is wrong at " + std::to_string(wrong) + " of " +
                             std::to_string(surface.vertex_count()) + " vertices; it must name one of the " +
                             std::to_string(fixed.count) + " fixed seeds at border vertices, and none elsewhere");
  FixedBorder border;
  border.vertex = exec.select(surface.vertex_count(), IsOnBorder{before});
  border.held = exec.template make<uint32_t>(fixed.count);
  border.next = exec.template make<uint32_t>(fixed.count);
  Buffer<uint32_t> runs = exec.template make<uint32_t>(fixed.count);
  exec.fill(border.held.view(), 0u);
  exec.fill(border.next.view(), kNone);
  exec.fill(runs.view(), 0u);
  exec.for_each(
      "follow borders", border.vertex.size(),
      FollowBorder{border.vertex.view(), before, of_vertex, border.held.view(), runs.view(), border.next.view()});
  const int64_t misplaced = exec.sum(fixed.count, IsMisplaced{runs.view(), border.next.view()});
  if (misplaced > 0)
    throw NoRoom("dual",
                 std::to_string(misplaced) + " of " + std::to_string(fixed.count) +
                     " fixed seeds have no single run of border vertices, or share their border with one other seed " +
                     "at most; place three or more along every border, each with the vertices around it");
  return border;
}

/// An edge of the dual, by the places that it has in the result. Those of borders come before others.
struct PositionedPair {
  static constexpr uint64_t kInside = uint64_t(1) << 63;  ///< in pair: no edge of a border
  uint64_t places, pair;
};
struct ByPositions {
  ISOSHELL_HD bool operator()(const PositionedPair& p, const PositionedPair& q) const {
    return p.places != q.places ? p.places < q.places : p.pair < q.pair;
  }
};
/// The first of equal pairs, where one of the two is a fixed seed: the smaller one, since these come first.
struct HasFixedEnd {
  View<const uint64_t> pair;
  int64_t fixed;
  ISOSHELL_HD bool operator()(int64_t i) const {
    return (i == 0 || pair[i - 1] != pair[i]) && int64_t(pair[i] >> 32) < fixed;
  }
};
struct PositionPair {
  View<const uint64_t> pair;
  View<const uint32_t> selected, joined, next;
  View<PositionedPair> out;
  ISOSHELL_HD uint32_t place(uint32_t s) const { return s < joined.size ? joined[s] : s; }
  ISOSHELL_HD void operator()(int64_t i) const {
    const uint64_t p = pair[selected[i]];
    const uint32_t a = uint32_t(p >> 32), b = uint32_t(p);
    const bool on_border = next[a] == b || (b < next.size && next[b] == a);
    out[i] = {MakePairs::key(place(a), place(b)), on_border ? p : p | PositionedPair::kInside};
  }
};
/// Once copies are joined, an edge of a border has the triangle of each of its patches, any other one just its own two:
/// pairs inside of patches part when their places are one, or are joined already.
struct RequestDoublePositions {
  View<const PositionedPair> placed;
  RequestParting part;
  ISOSHELL_HD void operator()(int64_t i) const {
    const PositionedPair p = placed[i];
    const bool is_double = (i > 0 && placed[i - 1].places == p.places) || p.places >> 32 == uint32_t(p.places);
    if (p.pair & PositionedPair::kInside && is_double) part(p.pair & ~PositionedPair::kInside);
  }
};
template <class Exec>
void request_double_positions(Exec& exec, View<const uint64_t> pairs, View<const uint32_t> joined,
                              View<const uint32_t> next, const RequestParting& part) {
  const Buffer<uint32_t> selected = exec.select(pairs.size, HasFixedEnd{pairs, joined.size});
  Buffer<PositionedPair> placed = exec.template make<PositionedPair>(selected.size());
  exec.for_each("place pairs", selected.size(), PositionPair{pairs, selected.view(), joined, next, placed.view()});
  exec.sort(placed.view(), ByPositions{});
  exec.for_each("check places", placed.size(), RequestDoublePositions{placed.view(), part});
}

}  // namespace isoshell::dual
