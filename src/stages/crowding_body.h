// drop_crowded_seeds (see stages.h), written once over an executor.
#pragma once

#include "stages/subdivide_body.h"

namespace isoshell {
namespace crowding {

struct DualEdge {
  int64_t length_sq;
  uint32_t a, b;  ///< a < b
};
/// Shortest first, then by the ends.
struct ShortestFirst {
  ISOSHELL_HD bool operator()(const DualEdge& e, const DualEdge& f) const {
    return e.length_sq != f.length_sq ? e.length_sq < f.length_sq : (e.a != f.a ? e.a < f.a : e.b < f.b);
  }
};
struct MeasureEdge {
  subdivide::StandsForEdge edges;
  View<const uint32_t> half_edge;
  View<const PointQ8> position;
  View<DualEdge> out;
  ISOSHELL_HD void operator()(int64_t i) const {
    const subdivide::Edge e = edges.edge(half_edge[i]);
    out[i] = {distance_sq_q16(position[e.a], position[e.b]), e.a, e.b};
  }
};

enum Fate : uint8_t { kFree, kSettled, kDropped };

/// One step for all edges: each choice depends on those before it, and few are made.
struct DropAtShortEdges {
  View<const DualEdge> edges;
  int64_t excess;
  View<uint8_t> fate;
  ISOSHELL_HD void operator()(int64_t) const {
    int64_t left = excess;
    for (int64_t i = 0; i < edges.size && left > 0; ++i) {
      const DualEdge e = edges[i];
      if (fate[e.a] != kFree || fate[e.b] != kFree) continue;
      fate[e.a] = kSettled;
      fate[e.b] = kDropped;
      --left;
    }
  }
};
struct IsKept {
  View<const uint8_t> fate;
  ISOSHELL_HD bool operator()(int64_t s) const { return fate[s] != kDropped; }
};
struct CopyKeptSeed {
  View<const uint32_t> kept;
  View<const PointQ8> from_position;
  View<const Normal8> from_normal;
  View<const uint32_t> from_home;
  View<PointQ8> position;
  View<Normal8> normal;
  View<uint32_t> home;
  ISOSHELL_HD void operator()(int64_t i) const {
    position[i] = from_position[kept[i]];
    normal[i] = from_normal[kept[i]];
    home[i] = from_home[kept[i]];
  }
};

}  // namespace crowding

template <class Exec>
void drop_crowded_seeds_body(Exec& exec, const DualMesh& mesh, int64_t excess, int64_t protected_count,
                             SeedSet& seeds) {
  using namespace crowding;
  if (excess <= 0) return;
  const int64_t count = seeds.size();
  const subdivide::StandsForEdge stands{mesh.triangles.view()};
  const Buffer<uint32_t> half_edges = exec.select(3 * mesh.triangles.size(), stands);
  Buffer<DualEdge> edges = exec.template make<DualEdge>(half_edges.size());
  exec.for_each("measure edges", edges.size(),
                MeasureEdge{stands, half_edges.view(), mesh.position.view(), edges.view()});
  exec.sort(edges.view(), ShortestFirst{});
  Buffer<uint8_t> fate = exec.template make<uint8_t>(count);
  exec.fill(fate.view().part(0, count - protected_count), uint8_t(kFree));
  exec.fill(fate.view().part(count - protected_count, protected_count), uint8_t(kSettled));
  exec.for_each("drop at short edges", 1, DropAtShortEdges{edges.view(), excess, fate.view()});
  const Buffer<uint32_t> kept = exec.select(count, IsKept{fate.view()});
  SeedSet out;
  out.position = exec.template make<PointQ8>(kept.size());
  out.normal = exec.template make<Normal8>(kept.size());
  out.home = exec.template make<uint32_t>(kept.size());
  exec.for_each("copy kept seeds", kept.size(),
                CopyKeptSeed{kept.view(), seeds.position.view(), seeds.normal.view(), seeds.home.view(),
                             out.position.view(), out.normal.view(), out.home.view()});
  seeds = std::move(out);
}

}  // namespace isoshell
