// The mesh that the optimisation works on: triangles with half-edge twins, and how a closed mesh gets them.
#pragma once

#include "isoshell/stages.h"
#include "stages/halfedge/labelled_triangles.h"
#include "voxel/atomic.h"

namespace isoshell::optimize {

/// Half-edge 3 t + i runs from corner i of triangle t to corner i + 1.
ISOSHELL_HD inline uint32_t corner(const TriangleIndices& t, int i) { return i == 0 ? t.a : (i == 1 ? t.b : t.c); }
ISOSHELL_HD inline uint32_t next_half_edge(uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
ISOSHELL_HD inline uint32_t previous_half_edge(uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }

/// A closed mesh with its half-edge twins, as steps see it.
struct MeshView {
  View<TriangleIndices> triangles;
  View<uint32_t> twin;
  View<uint32_t> valence;
  View<uint32_t> outgoing;  ///< some half-edge that starts at the vertex

  ISOSHELL_HD uint32_t from(uint32_t h) const { return corner(triangles[h / 3], int(h % 3)); }
  ISOSHELL_HD uint32_t to(uint32_t h) const { return from(next_half_edge(h)); }
  ISOSHELL_HD uint32_t opposite(uint32_t h) const { return from(previous_half_edge(h)); }
  /// Makes twins of two half-edges.
  ISOSHELL_HD void join(uint32_t g, uint32_t h) const {
    twin[g] = h;
    twin[h] = g;
  }
  ISOSHELL_HD bool are_neighbours(uint32_t u, uint32_t v) const {
    const uint32_t start = outgoing[u];
    uint32_t h = start;
    do {
      if (to(h) == v) return true;
      h = twin[previous_half_edge(h)];
    } while (h != start);
    return false;
  }
};

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
struct PairTwins {
  View<const DirectedEdge> edges;
  MeshView mesh;
  ISOSHELL_HD void operator()(int64_t pair) const {
    mesh.join(edges[2 * pair].half_edge, edges[2 * pair + 1].half_edge);
  }
};
struct CountValence {
  MeshView mesh;
  ISOSHELL_HD void operator()(int64_t h) const {
    const uint32_t v = mesh.from(uint32_t(h));
    atomic_add(mesh.valence[v], 1u);
    atomic_min(mesh.outgoing[v], uint32_t(h));
  }
};

/// Calls visit(b, c) for every triangle (v, b, c) around v, in the order of the half-edges from outgoing[v] on.
template <class Visit>
ISOSHELL_HD inline void for_each_triangle_around(const MeshView& mesh, uint32_t v, Visit visit) {
  const uint32_t start = mesh.outgoing[v];
  uint32_t h = start;
  do {
    visit(mesh.to(h), mesh.opposite(h));
    h = mesh.twin[previous_half_edge(h)];
  } while (h != start);
}

/// The half-edge structure of a mesh.
struct Connections {
  Buffer<uint32_t> twin, valence, outgoing;

  template <class Exec>
  Connections(Exec& exec, DualMesh& mesh)
      : twin(exec.template make<uint32_t>(3 * mesh.triangles.size())),
        valence(exec.template make<uint32_t>(mesh.position.size())),
        outgoing(exec.template make<uint32_t>(mesh.position.size())) {
    Buffer<DirectedEdge> edges = exec.template make<DirectedEdge>(twin.size());
    exec.for_each("list edges", twin.size(), ListEdge{mesh.triangles.view(), edges.view()});
    exec.sort(edges.view(), ByEnds{});
    exec.for_each("pair twins", twin.size() / 2, PairTwins{edges.view(), view(mesh)});
    exec.fill(valence.view(), 0u);
    exec.fill(outgoing.view(), kNone);
    exec.for_each("count valences", twin.size(), CountValence{view(mesh)});
  }
  MeshView view(DualMesh& mesh) { return {mesh.triangles.view(), twin.view(), valence.view(), outgoing.view()}; }
};

}  // namespace isoshell::optimize
