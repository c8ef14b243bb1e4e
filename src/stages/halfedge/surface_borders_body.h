// What a surface mesh knows of its own triangles: those around each vertex, and its borders, as chains.
#pragma once

#include "isoshell/surface_mesh.h"
#include "stages/halfedge/half_edges.h"
#include "voxel/union_find.h"

namespace isoshell {
namespace borders {

using optimize::MeshView;

struct IsBorder {
  MeshView mesh;
  ISOSHELL_HD bool operator()(int64_t h) const { return mesh.is_border(uint32_t(h)); }
};
/// A border half-edge says which vertex comes before its end, and joins both ends to one loop.
struct LinkEnds {
  MeshView mesh;
  View<const uint32_t> half_edge;
  View<uint32_t> before, loop;
  ISOSHELL_HD void operator()(int64_t i) const {
    const uint32_t u = mesh.from(half_edge[i]), v = mesh.to(half_edge[i]);
    before[v] = u;
    join(loop, u, v);
  }
};
/// Where a border does not go on one way only, back and forth.
struct IsMisfit {
  MeshView mesh;
  View<const uint32_t> half_edge, before;
  ISOSHELL_HD int64_t operator()(int64_t i) const {
    const uint32_t h = half_edge[i], u = mesh.from(h), v = mesh.to(h);
    return before[v] == u && mesh.outgoing[u] == h && mesh.is_border(mesh.outgoing[v]) ? 0 : 1;
  }
};
/// The smallest vertex of a loop.
struct BeginsLoop {
  View<const uint32_t> before, loop;
  ISOSHELL_HD bool operator()(int64_t v) const { return before[v] != kNone && loop[v] == v; }
};
/// From the first vertex of a loop along the border, which goes on with the half-edge that turns begin with.
template <class Visit>
ISOSHELL_HD inline void follow_loop(const MeshView& mesh, uint32_t first, Visit visit) {
  uint32_t v = first;
  do {
    visit(v);
    v = mesh.to(mesh.outgoing[v]);
  } while (v != first);
}
struct CountLoop {
  MeshView mesh;
  View<const uint32_t> begin;
  View<int64_t> count;
  ISOSHELL_HD void operator()(int64_t i) const {
    int64_t n = 0;
    follow_loop(mesh, begin[i], [&](uint32_t) { ++n; });
    count[i] = n;
  }
};
struct FillLoop {
  MeshView mesh;
  View<const uint32_t> begin;
  View<const int64_t> first;
  View<uint32_t> vertex;
  ISOSHELL_HD void operator()(int64_t i) const {
    int64_t at = first[i];
    follow_loop(mesh, begin[i], [&](uint32_t v) { vertex[at++] = v; });
  }
};

}  // namespace borders

/// Finds border_before and the chains of a surface with positions and triangles. Every component of a border is a loop.
/// Cost: a sort of the edges, then O(border), a thread a loop. Throws: usage where a border is that of no oriented
/// manifold.
template <class Exec>
void find_borders(Exec& exec, SurfaceMesh& surface) {
  using namespace borders;
  const int64_t vertices = surface.vertex_count();
  optimize::Connections connections(exec, surface.triangles.view(), vertices);
  const MeshView mesh = connections.view(surface.triangles.view());
  surface.border_before = {};
  surface.chains = {};
  const Buffer<uint32_t> half_edges = exec.select(3 * surface.triangles.size(), IsBorder{mesh});
  if (half_edges.empty()) return;

  surface.border_before = exec.template make<uint32_t>(vertices);
  exec.fill(surface.border_before.view(), kNone);
  Buffer<uint32_t> loop = exec.template make<uint32_t>(vertices);
  exec.for_each("start loops", vertices, StartAlone{loop.view()});
  exec.for_each("link border edges", half_edges.size(),
                LinkEnds{mesh, half_edges.view(), surface.border_before.view(), loop.view()});
  const int64_t misfits = exec.sum(half_edges.size(), IsMisfit{mesh, half_edges.view(), surface.border_before.view()});
  if (misfits > 0)
    throw Error(
        ErrorCode::usage, "surface",
        "at " + std::to_string(misfits) + " of " + std::to_string(half_edges.size()) +
            " border edges the triangles are no oriented manifold: an edge has three of them, or two that pass " +
            "it the same way, or those around a vertex are several fans; repair the faces first");
  exec.for_each("root loops", vertices, PointAtRoot{loop.view()});
  const Buffer<uint32_t> begin = exec.select(vertices, BeginsLoop{surface.border_before.view(), loop.view()});

  const int64_t loops = begin.size();
  Chains& chains = surface.chains;
  chains.first = exec.template make<int64_t>(loops + 1);
  exec.fill(chains.first.view().part(loops, 1), int64_t(0));
  exec.for_each("count loops", loops, CountLoop{mesh, begin.view(), chains.first.view()});
  chains.vertex = exec.template make<uint32_t>(exec.exclusive_scan(chains.first.view()));
  exec.for_each("fill loops", loops, FillLoop{mesh, begin.view(), chains.first.view(), chains.vertex.view()});
  chains.kind = exec.template make<ChainKind>(loops);
  exec.fill(chains.kind.view(), ChainKind::border);
  chains.is_loop = exec.template make<uint8_t>(loops);
  exec.fill(chains.is_loop.view(), uint8_t(1));
}

}  // namespace isoshell
