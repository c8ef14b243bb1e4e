// Half-edges: what is around a vertex of a mesh that may have borders, and how a mesh gets them.
#pragma once

#include <string>

#include "isoshell/advanced/stages.h"
#include "isoshell/error.h"
#include "stages/halfedge/labelled_triangles.h"
#include "voxel/atomic.h"

namespace isoshell::optimize {

/// Half-edge 3 t + i runs from corner i of triangle t to corner i + 1.
ISOSHELL_HD inline uint32_t corner(const TriangleIndices& t, int i) { return i == 0 ? t.a : (i == 1 ? t.b : t.c); }
ISOSHELL_HD inline uint32_t next_half_edge(uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
ISOSHELL_HD inline uint32_t previous_half_edge(uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }

/// An oriented manifold mesh with its half-edge twins, as steps see it. A half-edge of a border has no twin. Around a
/// border vertex one turns from the border on its right to the one on its left, seen from outside.
struct MeshView {
  View<TriangleIndices> triangles;
  View<uint32_t> twin;      ///< kNone on a border
  View<uint32_t> valence;   ///< number of edges
  View<uint32_t> outgoing;  ///< the half-edge from the vertex that turns begin with: on a border the one without twin

  ISOSHELL_HD uint32_t from(uint32_t h) const { return corner(triangles[h / 3], int(h % 3)); }
  ISOSHELL_HD uint32_t to(uint32_t h) const { return from(next_half_edge(h)); }
  ISOSHELL_HD uint32_t opposite(uint32_t h) const { return from(previous_half_edge(h)); }
  ISOSHELL_HD bool is_border(uint32_t h) const { return twin[h] == kNone; }
  ISOSHELL_HD bool is_on_border(uint32_t v) const { return is_border(outgoing[v]); }
  /// Makes twins of a half-edge and another one, which may be none.
  ISOSHELL_HD void join(uint32_t g, uint32_t h) const {
    twin[g] = h;
    if (h != kNone) twin[h] = g;
  }
  /// Lets turns around its start begin with h, unless they begin at a border elsewhere.
  ISOSHELL_HD void begin_turn(uint32_t v, uint32_t h, bool is_on_border) const {
    if (!is_on_border || is_border(h)) outgoing[v] = h;
  }
  /// The half-edge from the same vertex that comes next, beyond the triangle of h; after the last one of a border
  /// vertex comes the first again.
  ISOSHELL_HD uint32_t turned(uint32_t h) const {
    const uint32_t next = twin[previous_half_edge(h)];
    return next != kNone ? next : outgoing[from(h)];
  }
  /// Whether `is` holds of one of the half-edges from the vertex that `start` leaves, in turn from `start` on.
  template <class Is>
  ISOSHELL_HD bool any_from(uint32_t start, Is is) const {
    uint32_t h = start;
    do {
      if (is(h)) return true;
      h = turned(h);
    } while (h != start);
    return false;
  }
  ISOSHELL_HD bool are_neighbours(uint32_t u, uint32_t v) const {
    return any_from(outgoing[u],
                    [&](uint32_t h) { return to(h) == v || (is_border(previous_half_edge(h)) && opposite(h) == v); });
  }
};

/// Calls visit(h) for every half-edge from a vertex, one a triangle, from outgoing[v] on.
template <class Visit>
ISOSHELL_HD inline void for_each_half_edge_around(const MeshView& mesh, uint32_t v, Visit visit) {
  mesh.any_from(mesh.outgoing[v], [&](uint32_t h) {
    visit(h);
    return false;
  });
}
/// Calls visit(b, c) for every triangle (v, b, c) around v, in the same order.
template <class Visit>
ISOSHELL_HD inline void for_each_triangle_around(const MeshView& mesh, uint32_t v, Visit visit) {
  for_each_half_edge_around(mesh, v, [&](uint32_t h) { visit(mesh.to(h), mesh.opposite(h)); });
}
/// Calls visit(u) for every neighbour of v, in the same order; a border vertex has one more than triangles.
template <class Visit>
ISOSHELL_HD inline void for_each_neighbour(const MeshView& mesh, uint32_t v, Visit visit) {
  for_each_half_edge_around(mesh, v, [&](uint32_t h) {
    visit(mesh.to(h));
    if (mesh.is_border(previous_half_edge(h))) visit(mesh.opposite(h));
  });
}

struct DirectedEdge {
  uint64_t ends;  ///< smaller vertex << 32 | larger vertex
  uint32_t half_edge, zero = 0;
};
struct ByEnds {
  ISOSHELL_HD bool operator()(const DirectedEdge& a, const DirectedEdge& b) const {
    return a.ends != b.ends ? a.ends < b.ends : a.half_edge < b.half_edge;
  }
};
struct ListEdge {
  View<const TriangleIndices> triangles;
  View<DirectedEdge> out;
  ISOSHELL_HD void operator()(int64_t h) const {
    const uint32_t u = corner(triangles[h / 3], int(h % 3)), v = corner(triangles[h / 3], int((h + 1) % 3));
    out[h] = {u < v ? uint64_t(u) << 32 | v : uint64_t(v) << 32 | u, uint32_t(h)};
  }
};
/// Valences without the edges that end a turn, and the smallest half-edge of every vertex.
struct CountOutgoing {
  MeshView mesh;
  ISOSHELL_HD void operator()(int64_t h) const {
    const uint32_t v = mesh.from(uint32_t(h));
    atomic_add(mesh.valence[v], 1u);
    atomic_min(mesh.outgoing[v], uint32_t(h));
  }
};
/// Of the two half-edges of an edge, which are next to each other, the first one does it for both. One that is alone is
/// where the turn around its start begins, and where the one around its end ends.
struct PairTwins {
  View<const DirectedEdge> edges;
  MeshView mesh;
  View<uint32_t> border_edges;
  ISOSHELL_HD void operator()(int64_t i) const {
    bool is_first = true;
    for (int64_t j = i; j > 0 && edges[j - 1].ends == edges[i].ends; --j) is_first = !is_first;
    if (!is_first) return;
    const uint32_t h = edges[i].half_edge;
    if (i + 1 < edges.size && edges[i + 1].ends == edges[i].ends) return mesh.join(h, edges[i + 1].half_edge);
    mesh.twin[h] = kNone;
    mesh.outgoing[mesh.from(h)] = h;
    atomic_add(mesh.valence[mesh.to(h)], 1u);
    atomic_add(border_edges[0], 1u);
  }
};

/// Vertices on a border that are not among the first so many, others that are, and those without triangles.
struct IsBorderMisfit {
  MeshView mesh;
  int64_t fixed;
  ISOSHELL_HD int64_t operator()(int64_t v) const {
    return mesh.outgoing[v] == kNone || mesh.is_on_border(uint32_t(v)) != (v < fixed) ? 1 : 0;
  }
};

/// The half-edge structure of a mesh: an oriented manifold, closed or with borders.
struct Connections {
  Buffer<uint32_t> twin, valence, outgoing;
  Buffer<uint32_t> border_edges;  ///< one element, how many there are

  template <class Exec>
  Connections(Exec& exec, View<TriangleIndices> triangles, int64_t vertices)
      : twin(exec.template make<uint32_t>(3 * triangles.size)),
        valence(exec.template make<uint32_t>(vertices)),
        outgoing(exec.template make<uint32_t>(vertices)),
        border_edges(exec.template make<uint32_t>(1)) {
    exec.fill(valence.view(), 0u);
    exec.fill(outgoing.view(), kNone);
    exec.for_each("count outgoing half-edges", twin.size(), CountOutgoing{view(triangles)});
    Buffer<DirectedEdge> edges = exec.template make<DirectedEdge>(twin.size());
    exec.for_each("list edges", twin.size(), ListEdge{triangles, edges.view()});
    exec.sort(edges.view(), ByEnds{});
    exec.fill(border_edges.view(), 0u);
    exec.for_each("pair twins", twin.size(), PairTwins{edges.view(), view(triangles), border_edges.view()});
  }
  template <class Exec>
  Connections(Exec& exec, DualMesh& mesh) : Connections(exec, mesh.triangles.view(), mesh.position.size()) {}

  MeshView view(View<TriangleIndices> triangles) { return {triangles, twin.view(), valence.view(), outgoing.view()}; }
  MeshView view(DualMesh& mesh) { return view(mesh.triangles.view()); }

  /// For stages that can do with borders of the mesh's first vertices, so many, and with no others.
  template <class Exec>
  void require_borders_of(Exec& exec, View<TriangleIndices> triangles, int64_t fixed, const char* stage) {
    if (fixed == 0) return require_closed(exec, stage);
    const int64_t misfits = exec.sum(outgoing.size(), IsBorderMisfit{view(triangles), fixed});
    if (misfits > 0)
      throw Error(ErrorCode::usage, stage,
                  "the mesh has " + std::to_string(misfits) + " vertices that are fixed but not on its border, on it " +
                      "but not fixed, or in no triangle; with " + std::to_string(fixed) + " fixed seeds those must " +
                      "be its border, as triangulate_dual makes it");
  }
  /// For stages that can not do with a border.
  template <class Exec>
  void require_closed(Exec& exec, const char* stage) const {
    const uint32_t count = exec.value(border_edges.view(), 0);
    if (count > 0)
      throw Error(ErrorCode::usage, stage,
                  "the mesh has " + std::to_string(count) + " border edges; this stage needs a closed mesh, as " +
                      "triangulate_dual makes it");
  }
};

}  // namespace isoshell::optimize
