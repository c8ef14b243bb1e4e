#include "features/curves/small_creases.h"

#include <algorithm>
#include <numeric>

#include "core/index_sets.h"
#include "geometry/world_vector.h"

namespace isoshell {
namespace {

constexpr double kShortestLoose = 2;  // of h
constexpr double kSmallPatch = 6;     // of h: its border
constexpr double kSharedTurn = .5;    // 1 - cos 60 degrees: half of a crease of 120 degrees

/// The edges of the chains that stay, ascending.
template <class Stays>
std::vector<CurveEdge> edges_of(const std::vector<EdgeChain>& chains, const std::vector<CurveEdge>& all, Stays stays) {
  std::vector<CurveEdge> kept;
  const auto by_edge = [](const CurveEdge& a, const CurveEdge& b) { return a.edge < b.edge; };
  for (size_t c = 0; c < chains.size(); ++c)
    if (stays(c))
      for (const uint32_t e : chains[c].edge)
        kept.push_back(*std::lower_bound(all.begin(), all.end(), CurveEdge{e, chains[c].kind, 0}, by_edge));
  std::sort(kept.begin(), kept.end(), by_edge);
  return kept;
}

std::vector<CurveEdge> drop_short(const FeatureMesh& mesh, const MeshEdges& edges, std::vector<CurveEdge> all,
                                  double edge_length_world) {
  const double longest = kShortestLoose * edge_length_world;
  std::vector<EdgeChain> chains = find_chains(edges, all);
  // The shortest go first: a spur must not take what it stands on with it.
  for (double limit = longest / 8; limit <= longest; limit *= 2) {
    const auto is_short = [&](const EdgeChain& chain) {
      const bool is_loose = chain.degree[0] == 1 || chain.degree[1] == 1 || chain.vertex.front() == chain.vertex.back();
      return chain.kind == CurveKind::crease && is_loose && length_of(mesh, chain) < limit;
    };
    while (std::any_of(chains.begin(), chains.end(), is_short)) {
      all = edges_of(chains, all, [&](size_t c) { return !is_short(chains[c]); });
      chains = find_chains(edges, all);
    }
  }
  return all;
}

/// The patches that curve edges cut a mesh into.
class Patches {
 public:
  Patches(const FeatureMesh& mesh, const MeshEdges& edges, const std::vector<CurveEdge>& all)
      : sets_(int64_t(mesh.triangles.size())), border_world_(mesh.triangles.size(), 0) {
    auto curve = all.begin();
    for (uint32_t e = 0; e < edges.count(); ++e)
      if (curve != all.end() && curve->edge == e)
        ++curve;
      else
        sets_.unite(edges.edges[e].face[0], edges.edges[e].face[1]);
    for (const CurveEdge& c : all) {
      const FeatureEdge& e = edges.edges[c.edge];
      for (const uint32_t f : e.face) border_world_[of(f)] += length(mesh.vertices[e.end[1]] - mesh.vertices[e.end[0]]);
    }
  }

  uint32_t of(uint32_t face) { return sets_.root(face); }
  double border_world(uint32_t patch) const { return border_world_[patch]; }

 private:
  IndexSets sets_;  // per triangle, the smallest of its patch
  std::vector<double> border_world_;
};

/// Every small patch gives up the weakest crease between it and another.
std::vector<CurveEdge> drop_shared(const FeatureMesh& mesh, const MeshEdges& edges, std::vector<CurveEdge> all,
                                   double edge_length_world) {
  constexpr size_t kNoChain = SIZE_MAX;
  const auto may_go = [](const EdgeChain& chain) {
    return chain.kind == CurveKind::crease && chain.turn < kSharedTurn && !chain.is_ring;
  };
  for (size_t before = all.size() + 1; all.size() < before;) {
    before = all.size();
    const std::vector<EdgeChain> chains = find_chains(edges, all);
    if (std::none_of(chains.begin(), chains.end(), may_go)) break;  // patches cost a look at every edge
    Patches patches(mesh, edges, all);
    std::vector<size_t> weakest(mesh.triangles.size(), kNoChain);
    for (size_t c = 0; c < chains.size(); ++c) {
      if (!may_go(chains[c])) continue;
      const auto& face = edges.edges[chains[c].edge[0]].face;
      if (patches.of(face[0]) == patches.of(face[1])) continue;
      for (const uint32_t f : face) {
        size_t& best = weakest[patches.of(f)];
        if (patches.border_world(patches.of(f)) < kSmallPatch * edge_length_world &&
            (best == kNoChain || chains[c].turn < chains[best].turn))
          best = c;
      }
    }
    std::vector<uint8_t> is_dropped(chains.size(), 0);
    for (const size_t c : weakest)
      if (c != kNoChain) is_dropped[c] = 1;
    if (std::find(is_dropped.begin(), is_dropped.end(), 1) == is_dropped.end()) break;
    all = edges_of(chains, all, [&](size_t c) { return !is_dropped[c]; });
  }
  return all;
}

}  // namespace

std::vector<CurveEdge> drop_small_creases(const FeatureMesh& mesh, const MeshEdges& edges,
                                          std::vector<CurveEdge> curve_edges, double edge_length_world) {
  for (size_t before = curve_edges.size() + 1; curve_edges.size() < before;) {
    before = curve_edges.size();
    curve_edges = drop_short(mesh, edges, std::move(curve_edges), edge_length_world);
    curve_edges = drop_shared(mesh, edges, std::move(curve_edges), edge_length_world);
  }
  return curve_edges;
}

std::vector<CurveEdge> drop_least_creases(const FeatureMesh& mesh, const MeshEdges& edges,
                                          std::vector<CurveEdge> curve_edges, double edge_length_world,
                                          double most_vertices) {
  // What is left joins to longer chains, of fewer vertices, some of which end freely.
  for (;;) {
    const std::vector<EdgeChain> chains = find_chains(edges, curve_edges);
    std::vector<double> vertices, value;
    for (const EdgeChain& chain : chains) {
      const double length_world = length_of(mesh, chain);
      vertices.push_back(std::max(1., length_world / edge_length_world));
      value.push_back(chain.turn * length_world);
    }
    double needed = std::accumulate(vertices.begin(), vertices.end(), 0.);
    std::vector<size_t> least_first;
    for (size_t c = 0; c < chains.size(); ++c)
      if (chains[c].kind == CurveKind::crease) least_first.push_back(c);
    std::stable_sort(least_first.begin(), least_first.end(), [&](size_t a, size_t b) { return value[a] < value[b]; });
    std::vector<uint8_t> is_dropped(chains.size(), 0);
    for (size_t i = 0; i < least_first.size() && needed > most_vertices; ++i) {
      is_dropped[least_first[i]] = 1;
      needed -= vertices[least_first[i]];
    }
    if (std::find(is_dropped.begin(), is_dropped.end(), 1) == is_dropped.end()) return curve_edges;
    curve_edges = edges_of(chains, curve_edges, [&](size_t c) { return !is_dropped[c]; });
    curve_edges = drop_small_creases(mesh, edges, std::move(curve_edges), edge_length_world);
  }
}

}  // namespace isoshell
