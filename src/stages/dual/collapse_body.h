// collapse_edges (see stages.h), written once over an executor.
#pragma once

#include "isoshell/advanced/stages.h"
#include "stages/halfedge/collapse_cost.h"
#include "stages/halfedge/half_edges.h"
#include "stages/labels/label_body.h"
#include "stages/sheet/sheet_walk.h"

namespace isoshell {
namespace collapse {

struct Candidate {
  int64_t cost;
  uint32_t half_edge, zero = 0;
};
struct CheapestFirst {
  ISOSHELL_HD bool operator()(const Candidate& p, const Candidate& q) const {
    return p.cost != q.cost ? p.cost < q.cost : p.half_edge < q.half_edge;
  }
};

/// Once per half-edge: a cost takes turns around both ends.
struct FindCosts {
  CollapseCost cost;
  View<int64_t> out;
  ISOSHELL_HD void operator()(int64_t h) const { out[h] = cost(uint32_t(h)); }
};
struct MayCollapse {
  View<const int64_t> cost;
  ISOSHELL_HD bool operator()(int64_t h) const { return cost[h] != CollapseCost::kNever; }
};
struct MakeCandidate {
  View<const int64_t> cost;
  View<const uint32_t> half_edge;
  View<Candidate> out;
  ISOSHELL_HD void operator()(int64_t i) const { out[i] = {cost[half_edge[i]], half_edge[i]}; }
};

/// One step for all candidates: each choice depends on those before it, and few are made. Chosen edges have no
/// neighbours in common, so that none changes what another one costs.
struct ChooseEdges {
  optimize::MeshView mesh;
  View<const Candidate> candidates;
  int64_t excess;
  View<uint8_t> taken;
  View<uint32_t> merged_into;
  ISOSHELL_HD void operator()(int64_t) const {
    int64_t left = excess;
    for (int64_t i = 0; i < candidates.size && left > 0; ++i) {
      const uint32_t a = mesh.from(candidates[i].half_edge), b = mesh.to(candidates[i].half_edge);
      if (any_taken_around(a) || any_taken_around(b)) continue;
      take_around(a);
      take_around(b);
      merged_into[b] = a;
      --left;
    }
  }

 private:
  ISOSHELL_HD bool any_taken_around(uint32_t v) const {
    bool any = false;
    optimize::for_each_neighbour(mesh, v, [&](uint32_t p) { any = any || taken[p]; });
    return any;
  }
  ISOSHELL_HD void take_around(uint32_t v) const {
    optimize::for_each_neighbour(mesh, v, [&](uint32_t p) { taken[p] = 1; });
  }
};

struct StartApart {
  View<uint32_t> merged_into;
  ISOSHELL_HD void operator()(int64_t v) const { merged_into[v] = uint32_t(v); }
};
struct StaysVertex {
  View<const uint32_t> merged_into;
  ISOSHELL_HD bool operator()(int64_t v) const { return merged_into[v] == v; }
};
/// Merged vertices go to the middle of their edge, then back onto the sheet; fixed ones stay.
struct MoveToMiddle {
  WalkOntoSheet walk;
  int64_t fixed;
  View<const uint32_t> merged_into;
  View<PointQ8> position;
  View<Normal8> normal;
  View<uint32_t> home;
  ISOSHELL_HD void operator()(int64_t v) const {
    const uint32_t into = merged_into[v];
    if (into == v || into < fixed) return;
    const PointQ8 middle = CollapseCost::middle_of(position[into], position[v]);
    home[into] = walk.nearest_vertex(home[into], middle);
    normal[into] = walk.normal[home[into]];
    position[into] = walk.closest_around(home[into], middle);
  }
};

struct NumberKept {
  View<const uint32_t> kept;
  View<uint32_t> new_id;
  ISOSHELL_HD void operator()(int64_t i) const { new_id[kept[i]] = uint32_t(i); }
};
struct CopyKeptSeed {
  View<const uint32_t> kept;
  View<const PointQ8> from_position;
  View<const Normal8> from_normal;
  View<const uint32_t> from_home;
  View<PointQ8> position, vertex;
  View<Normal8> normal;
  View<uint32_t> home;
  ISOSHELL_HD void operator()(int64_t i) const {
    vertex[i] = position[i] = from_position[kept[i]];
    normal[i] = from_normal[kept[i]];
    home[i] = from_home[kept[i]];
  }
};
template <class T>
struct CopyKept {
  View<const uint32_t> kept;
  View<const T> from;
  View<T> to;
  ISOSHELL_HD void operator()(int64_t i) const { to[i] = from[kept[i]]; }
};
struct CopyKeptTriangle {
  View<const uint32_t> kept, merged_into, new_id;
  View<const TriangleIndices> from;
  View<TriangleIndices> to;
  ISOSHELL_HD void operator()(int64_t i) const {
    const TriangleIndices t = from[kept[i]];
    to[i] = smallest_first({new_id[merged_into[t.a]], new_id[merged_into[t.b]], new_id[merged_into[t.c]]});
  }
};

struct KeepId {
  View<const uint32_t> was;
  View<uint32_t> by_id;
  ISOSHELL_HD void operator()(int64_t v) const {
    if (was[v] < by_id.size) by_id[was[v]] = uint32_t(v);
  }
};
struct IsFree {
  View<const uint32_t> by_id;
  ISOSHELL_HD bool operator()(int64_t id) const { return by_id[id] == kNone; }
};
struct TakeFreeId {
  View<const uint32_t> free_id;
  uint32_t first;  ///< of the vertices without an id
  View<uint32_t> by_id;
  ISOSHELL_HD void operator()(int64_t i) const { by_id[free_id[i]] = first + uint32_t(i); }
};

/// Numbers what stays anew: vertex i becomes what kept[i] was.
template <class Exec>
void renumber(Exec& exec, View<const uint32_t> kept, View<const uint32_t> merged_into, SeedSet& seeds, DualMesh& mesh) {
  const Buffer<uint32_t> triangles =
      exec.select(mesh.triangles.size(), HasThreeLabels{mesh.triangles.view(), merged_into});
  Buffer<uint32_t> new_id = exec.template make<uint32_t>(merged_into.size);
  exec.for_each("number vertices", kept.size, NumberKept{kept, new_id.view()});
  SeedSet left;
  left.position = exec.template make<PointQ8>(kept.size);
  left.normal = exec.template make<Normal8>(kept.size);
  left.home = exec.template make<uint32_t>(kept.size);
  left.fixed = std::move(seeds.fixed);  // which come first, and all stay
  DualMesh out;
  out.position = exec.template make<PointQ8>(kept.size);
  out.triangles = exec.template make<TriangleIndices>(triangles.size());
  exec.for_each("copy kept seeds", kept.size,
                CopyKeptSeed{kept, seeds.position.view(), seeds.normal.view(), seeds.home.view(), left.position.view(),
                             out.position.view(), left.normal.view(), left.home.view()});
  exec.for_each(
      "copy kept triangles", triangles.size(),
      CopyKeptTriangle{triangles.view(), merged_into, new_id.view(), mesh.triangles.view(), out.triangles.view()});
  exec.sort(out.triangles.view(), ByIndices{});
  seeds = std::move(left);
  mesh = std::move(out);
}

/// Per id the vertex that gets it, from the ids that the vertices had, ascending: those below their number keep them,
/// and the others take what is free.
template <class Exec>
Buffer<uint32_t> vertices_by_kept_ids(Exec& exec, View<const uint32_t> was) {
  const int64_t vertices = was.size;
  Buffer<uint32_t> by_id = exec.template make<uint32_t>(vertices);
  exec.fill(by_id.view(), kNone);
  exec.for_each("keep ids", vertices, KeepId{was, by_id.view()});
  const Buffer<uint32_t> free_ids = exec.select(vertices, IsFree{View<const uint32_t>(by_id.view())});
  exec.for_each("take free ids", free_ids.size(),
                TakeFreeId{free_ids.view(), uint32_t(vertices - free_ids.size()), by_id.view()});
  return by_id;
}

}  // namespace collapse

template <class Exec>
void collapse_edges_body(Exec& exec, const SurfaceMesh& surface, const CollapseOptions& options, SeedSet& seeds,
                         DualMesh& mesh) {
  using namespace collapse;
  const WalkOntoSheet walk = walk_onto(surface);
  Buffer<uint32_t> fixed_valence;  // of the mesh as it comes in, see optimize::FixedView
  Buffer<uint32_t> was = exec.template make<uint32_t>(options.keep_ids ? seeds.size() : 0);  // their ids, ascending
  exec.for_each("number vertices", was.size(), StartApart{was.view()});
  for (bool any = true; any && seeds.size() > options.target;) {
    const int64_t before = seeds.size();
    optimize::Connections connections(exec, mesh);
    connections.require_borders_of(exec, mesh.triangles.view(), seeds.fixed.count, "collapse");
    if (fixed_valence.empty())
      fixed_valence = optimize::even_valences(exec, seeds.fixed, connections.view(mesh), mesh.position.view());
    const CollapseCost cost{connections.view(mesh),
                            seeds.position.view(),
                            seeds.home.view(),
                            lengths_of(surface),
                            {seeds.fixed.joined.view(), fixed_valence.view()}};
    Buffer<int64_t> costs = exec.template make<int64_t>(3 * mesh.triangles.size());
    exec.for_each("find costs", costs.size(), FindCosts{cost, costs.view()});
    const Buffer<uint32_t> half_edges = exec.select(costs.size(), MayCollapse{costs.view()});
    Buffer<Candidate> candidates = exec.template make<Candidate>(half_edges.size());
    exec.for_each("make candidates", candidates.size(),
                  MakeCandidate{costs.view(), half_edges.view(), candidates.view()});
    exec.sort(candidates.view(), CheapestFirst{});
    Buffer<uint8_t> taken = exec.template make<uint8_t>(before);
    Buffer<uint32_t> merged_into = exec.template make<uint32_t>(before);
    exec.fill(taken.view(), uint8_t(0));
    exec.for_each("start apart", before, StartApart{merged_into.view()});
    exec.for_each("choose edges", 1,
                  ChooseEdges{cost.mesh, candidates.view(), before - options.target, taken.view(), merged_into.view()});
    exec.for_each("move to the middle", before,
                  MoveToMiddle{walk, seeds.fixed.count, merged_into.view(), seeds.position.view(), seeds.normal.view(),
                               seeds.home.view()});
    const Buffer<uint32_t> kept = exec.select(before, StaysVertex{merged_into.view()});
    renumber(exec, kept.view(), merged_into.view(), seeds, mesh);
    if (options.keep_ids) {
      Buffer<uint32_t> still = exec.template make<uint32_t>(kept.size());
      exec.for_each("copy ids", kept.size(), CopyKept<uint32_t>{kept.view(), was.view(), still.view()});
      was = std::move(still);
    }
    any = seeds.size() < before;
  }
  if (!options.keep_ids) return;
  const Buffer<uint32_t> by_id = vertices_by_kept_ids(exec, was.view());
  Buffer<uint32_t> alone = exec.template make<uint32_t>(seeds.size());
  exec.for_each("start apart", alone.size(), StartApart{alone.view()});
  renumber(exec, by_id.view(), alone.view(), seeds, mesh);
}

}  // namespace isoshell
