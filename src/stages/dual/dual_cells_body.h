// The cells of the dual: which vertices a seed owns, in how many pieces, and whether they form a disk.
#pragma once

#include "isoshell/advanced/stages.h"
#include "stages/sheet/sheet_graph.h"
#include "voxel/atomic.h"
#include "voxel/exact_int.h"
#include "voxel/union_find.h"

namespace isoshell::dual {

/// What is known of every cell; index is the seed id. A cell's main piece is its largest connected set of vertices, the
/// one with the smallest vertex among equals; of a fixed seed the one on the border.
struct CellsView {
  View<uint32_t> size;        ///< vertices of the main piece; 0 when the seed owns nothing
  View<uint32_t> root;        ///< a vertex of the main piece; kNone when the seed owns nothing
  View<int32_t> euler;        ///< V - E + F of the vertices with this label; 1 for a disk, once there is only one piece
  View<const uint32_t> held;  ///< per fixed seed its border vertices, which stay in its cell

  ISOSHELL_HD bool is_fixed(int64_t s) const { return s < held.size; }
  /// How many vertices a split could take away: a free cell keeps one, a fixed one those on the border.
  ISOSHELL_HD uint32_t loose(int64_t s) const {
    const uint32_t kept = is_fixed(s) ? held[s] : 1;
    return size[s] > kept ? size[s] - kept : 0;
  }
};
struct Cells {
  Buffer<uint32_t> size;
  Buffer<uint32_t> root;
  Buffer<int32_t> euler;
  Buffer<uint32_t> held;
  CellsView view() { return {size.view(), root.view(), euler.view(), held.view()}; }
  int64_t count() const { return size.size(); }
};

template <class T>
struct CopyOrFill {
  View<const T> from;
  View<T> to;
  T rest;
  ISOSHELL_HD void operator()(int64_t i) const { to[i] = i < from.size ? from[i] : rest; }
};
template <class Exec, class T>
void grow(Exec& exec, Buffer<T>& values, int64_t count, T rest) {
  Buffer<T> larger = exec.template make<T>(count);
  exec.for_each("grow", count, CopyOrFill<T>{values.view(), larger.view(), rest});
  values = std::move(larger);
}
/// The same for three arrays of one size.
template <class A, class B, class C>
struct CopyOrFillThree {
  CopyOrFill<A> a;
  CopyOrFill<B> b;
  CopyOrFill<C> c;
  ISOSHELL_HD void operator()(int64_t i) const {
    a(i);
    b(i);
    c(i);
  }
};
template <class Exec, class A, class B, class C>
void grow(Exec& exec, int64_t count, Buffer<A>& a, A rest_a, Buffer<B>& b, B rest_b, Buffer<C>& c, C rest_c) {
  Buffer<A> larger_a = exec.template make<A>(count);
  Buffer<B> larger_b = exec.template make<B>(count);
  Buffer<C> larger_c = exec.template make<C>(count);
  exec.for_each("grow", count,
                CopyOrFillThree<A, B, C>{{a.view(), larger_a.view(), rest_a},
                                         {b.view(), larger_b.view(), rest_b},
                                         {c.view(), larger_c.view(), rest_c}});
  a = std::move(larger_a);
  b = std::move(larger_b);
  c = std::move(larger_c);
}
template <class Exec>
void grow(Exec& exec, Cells& cells, int64_t count) {
  grow(exec, count, cells.size, uint32_t(0), cells.root, kNone, cells.euler, int32_t(0));
}
template <class Exec>
void grow(Exec& exec, SeedSet& seeds, int64_t count) {
  grow(exec, count, seeds.position, PointQ8{0, 0, 0}, seeds.normal, Normal8{0, 0, 0}, seeds.home, uint32_t(0));
}

/// Puts seed `id` onto a sheet vertex.
struct SeedWriter {
  View<const PointQ8> vertex_position;
  View<const Normal8> vertex_normal;
  View<PointQ8> position;
  View<Normal8> normal;
  View<uint32_t> home;
  ISOSHELL_HD void put(uint32_t id, uint32_t vertex) const {
    position[id] = vertex_position[vertex];
    normal[id] = vertex_normal[vertex];
    home[id] = vertex;
  }
};
inline SeedWriter writer_of(const SurfaceMesh& surface, SeedSet& seeds) {
  return {surface.position.view(), surface.normal.view(), seeds.position.view(), seeds.normal.view(),
          seeds.home.view()};
}

/// Hooks the ends of every edge with one label. Each edge is seen twice; the triangle that runs up it counts.
struct HookEqualLabels {
  View<const TriangleIndices> triangles;
  View<const uint32_t> label;
  View<uint32_t> parent;
  ISOSHELL_HD void operator()(int64_t i) const {
    const TriangleIndices t = triangles[i];
    const uint32_t a = label[t.a], b = label[t.b], c = label[t.c];
    if (a == b && t.a < t.b) join(parent, t.a, t.b);
    if (b == c && t.b < t.c) join(parent, t.b, t.c);
    if (c == a && t.c < t.a) join(parent, t.c, t.a);
  }
};

/// Counts the elements of every group; a run of elements of one group is added at once.
template <class T>
struct CountGroups {
  static constexpr int64_t kRun = 64;
  View<const uint32_t> group;  ///< of every element
  View<T> count;               ///< of every group
  ISOSHELL_HD void operator()(int64_t run) const {
    const int64_t begin = run * kRun, end = begin + kRun < group.size ? begin + kRun : group.size;
    uint32_t current = group[begin];
    T length = 0;
    for (int64_t v = begin; v < end; ++v) {
      if (group[v] != current) {
        atomic_add(count[current], length);
        current = group[v];
        length = 0;
      }
      ++length;
    }
    atomic_add(count[current], length);
  }
};
/// Sets `count` to the sizes of the groups.
template <class Exec, class T>
void count_groups(Exec& exec, const char* name, View<const uint32_t> group, View<T> count) {
  exec.fill(count, T(0));
  exec.for_each(name, (group.size + CountGroups<T>::kRun - 1) / CountGroups<T>::kRun, CountGroups<T>{group, count});
}

/// Larger is better, then the smaller root.
ISOSHELL_HD inline uint64_t piece_rank(uint32_t size, uint32_t root) { return uint64_t(size) << 32 | uint32_t(~root); }

struct RankMainPieces {
  View<const uint32_t> piece, size, label;
  View<uint64_t> best;
  ISOSHELL_HD void operator()(int64_t v) const {
    if (piece[v] == v) atomic_max(best[label[v]], piece_rank(size[v], uint32_t(v)));
  }
};
/// The piece on the border comes before all others of its cell.
struct RankHeldPieces {
  static constexpr uint64_t kHeld = uint64_t(1) << 63;
  View<const uint32_t> border_vertex, piece, size, label;
  View<uint64_t> best;
  ISOSHELL_HD void operator()(int64_t i) const {
    const uint32_t v = border_vertex[i], root = piece[v];
    atomic_max(best[label[v]], kHeld | piece_rank(size[root], root));
  }
};
struct TakeMainPiece {
  View<const uint64_t> best;
  CellsView cells;
  ISOSHELL_HD void operator()(int64_t s) const {
    cells.size[s] = uint32_t((best[s] & ~RankHeldPieces::kHeld) >> 32);
    cells.root[s] = best[s] ? ~uint32_t(best[s]) : kNone;
    cells.euler[s] = 0;
  }
};

/// Hooks the ends of border edges with one label, which no second triangle runs up.
struct HookBorderEdges {
  View<const uint32_t> border_vertex, before, label;
  View<uint32_t> parent;
  ISOSHELL_HD void operator()(int64_t i) const {
    const uint32_t v = border_vertex[i], u = before[v];
    if (label[u] == label[v]) join(parent, u, v);
  }
};

/// Pieces of the labels: piece[v] is the smallest vertex that v reaches within its label. `size` is per piece root.
struct Pieces {
  Buffer<uint32_t> piece;
  Buffer<uint32_t> size;
};
template <class Exec>
Pieces find_pieces(Exec& exec, const SurfaceMesh& surface, View<const uint32_t> label,
                   View<const uint32_t> border_vertex, Cells& cells) {
  const int64_t n = surface.vertex_count();
  Pieces pieces{exec.template make<uint32_t>(n), exec.template make<uint32_t>(n)};
  exec.for_each("start pieces", n, StartAlone{pieces.piece.view()});
  exec.for_each("hook pieces", surface.triangles.size(),
                HookEqualLabels{surface.triangles.view(), label, pieces.piece.view()});
  exec.for_each("hook border edges", border_vertex.size,
                HookBorderEdges{border_vertex, surface.border_before.view(), label, pieces.piece.view()});
  exec.for_each("root pieces", n, PointAtRoot{pieces.piece.view()});
  count_groups(exec, "count pieces", View<const uint32_t>(pieces.piece.view()), pieces.size.view());
  Buffer<uint64_t> best = exec.template make<uint64_t>(cells.count());
  exec.fill(best.view(), uint64_t(0));
  exec.for_each("rank pieces", n, RankMainPieces{pieces.piece.view(), pieces.size.view(), label, best.view()});
  exec.for_each("rank pieces on borders", border_vertex.size,
                RankHeldPieces{border_vertex, pieces.piece.view(), pieces.size.view(), label, best.view()});
  exec.for_each("take main pieces", cells.count(), TakeMainPiece{best.view(), cells.view()});
  return pieces;
}

/// Euler numbers: vertices first, then every triangle adds its own face and the edges that it runs up.
struct AddTrianglesToEuler {
  View<const TriangleIndices> triangles;
  View<const uint32_t> label;
  View<int32_t> euler;
  ISOSHELL_HD void operator()(int64_t i) const {
    const TriangleIndices t = triangles[i];
    const uint32_t a = label[t.a], b = label[t.b], c = label[t.c];
    if (a == b && b == c) {
      const int32_t change = 1 - int32_t(t.a < t.b) - int32_t(t.b < t.c) - int32_t(t.c < t.a);
      if (change) atomic_add(euler[a], change);
      return;
    }
    if (a == b && t.a < t.b) atomic_add(euler[a], -1);
    if (b == c && t.b < t.c) atomic_add(euler[b], -1);
    if (c == a && t.c < t.a) atomic_add(euler[c], -1);
  }
};
/// The edges of borders that their one triangle runs down.
struct AddBorderEdgesToEuler {
  View<const uint32_t> border_vertex, before, label;
  View<int32_t> euler;
  ISOSHELL_HD void operator()(int64_t i) const {
    const uint32_t v = border_vertex[i], u = before[v];
    if (u > v && label[u] == label[v]) atomic_add(euler[label[v]], -1);
  }
};
template <class Exec>
void measure_euler(Exec& exec, const SurfaceMesh& surface, View<const uint32_t> label,
                   View<const uint32_t> border_vertex, Cells& cells) {
  count_groups(exec, "count vertices of cells", label, cells.euler.view());
  exec.for_each("count edges and faces of cells", surface.triangles.size(),
                AddTrianglesToEuler{surface.triangles.view(), label, cells.euler.view()});
  exec.for_each("count border edges of cells", border_vertex.size,
                AddBorderEdgesToEuler{border_vertex, surface.border_before.view(), label, cells.euler.view()});
}

struct OwnsNothing {
  View<const uint32_t> size;
  ISOSHELL_HD bool operator()(int64_t s) const { return size[s] == 0; }
};

}  // namespace isoshell::dual
