#include "features/curves/crease_gaps.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <unordered_map>
#include <utility>

#include "core/parallel_ranges.h"
#include "features/curves/face_normals.h"

namespace isoshell {
namespace {

constexpr double kStraightOn = .5;          // cosine between a crease and the way on: 60 degrees
constexpr double kTurnsDegrees = 20;        // from these on an edge counts as long as it is
constexpr double kDirectionInReaches = .5;  // of a crease, of which its direction is taken
constexpr size_t kMostAround = 64;          // edges at a vertex: no way leads through the middle of a larger fan
constexpr size_t kMostSteps = 4096;         // vertices that one end looks at, however fine the mesh is
constexpr double kLeastRing = 4;            // reaches: shorter creases do not become rings

/// Where a crease ends freely.
struct FreeEnd {
  uint32_t vertex, edge;  ///< its last ones
  uint32_t chain;
  WorldPoint direction;
};

class Gaps {
 public:
  Gaps(const FeatureMesh& mesh, const MeshEdges& edges, View<const double> turns,
       const std::vector<CurveEdge>& curve_edges, double reach_world)
      : mesh_(mesh),
        edges_(edges),
        turns_(turns),
        reach_world_(reach_world),
        chains_(find_chains(edges, curve_edges)),
        chain_(mesh.vertices.size(), kNone) {
    for (uint32_t c = 0; c < chains_.size(); ++c)
      for (const uint32_t v : chains_[c].vertex) chain_[v] = chain_[v] == kNone || chain_[v] == c ? c : kSeveral;
  }

  std::vector<uint32_t> edges_across() const {
    const std::vector<FreeEnd> ends = free_ends();
    std::vector<std::vector<uint32_t>> ways(ends.size());
    for_each_index(size_t(0), ends.size(), [&](size_t i) { ways[i] = way_on(ends[i]); });
    std::vector<uint32_t> all;
    for (const std::vector<uint32_t>& way : ways) all.insert(all.end(), way.begin(), way.end());
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
  }

 private:
  static constexpr uint32_t kNone = UINT32_MAX, kSeveral = UINT32_MAX - 1;

  /// How a vertex is reached.
  struct Step {
    double cost;
    uint32_t edge, from;
    bool is_done = false;
  };
  using Steps = std::unordered_map<uint32_t, Step>;

  std::vector<FreeEnd> free_ends() const {
    std::vector<FreeEnd> ends;
    for (uint32_t c = 0; c < chains_.size(); ++c) {
      const EdgeChain& chain = chains_[c];
      if (chain.kind != CurveKind::crease || chain.is_ring) continue;
      for (const size_t end : {size_t(0), size_t(1)})
        if (chain.degree[end] == 1)
          ends.push_back({end == 0 ? chain.vertex.front() : chain.vertex.back(),
                          end == 0 ? chain.edge.front() : chain.edge.back(), c, direction(chain, end == 0)});
    }
    return ends;
  }

  /// Out of the chain's first or last vertex.
  WorldPoint direction(const EdgeChain& chain, bool is_first) const {
    const size_t count = chain.vertex.size();
    const auto at = [&](size_t i) { return mesh_.vertices[chain.vertex[is_first ? i : count - 1 - i]]; };
    size_t back = 1;
    while (back + 1 < count && length(at(back) - at(0)) < kDirectionInReaches * reach_world_) ++back;
    return at(0) - at(back);
  }

  bool is_goal(const FreeEnd& end, uint32_t v) const {
    if (chain_[v] == kNone || v == end.vertex) return false;
    if (chain_[v] != end.chain) return true;
    const EdgeChain& own = chains_[end.chain];
    return (v == own.vertex.front() || v == own.vertex.back()) && length_of(mesh_, own) >= kLeastRing * reach_world_;
  }

  /// A vertex of the crease itself, along which no way leads.
  bool is_on_own(const FreeEnd& end, uint32_t v) const { return chain_[v] == end.chain && !is_goal(end, v); }

  bool is_straight_on(const FreeEnd& end, uint32_t v) const {
    const WorldPoint way = mesh_.vertices[v] - mesh_.vertices[end.vertex];
    return dot(way, end.direction) >= kStraightOn * std::sqrt(length_sq(way) * length_sq(end.direction));
  }

  double cost(uint32_t edge) const {
    const auto& [a, b] = edges_.edges[edge].end;
    const double turned = std::min(1., turns_[edge] / turn_of_degrees(kTurnsDegrees));
    return (2 - turned) * length(mesh_.vertices[b] - mesh_.vertices[a]);
  }

  /// Inner edges at a vertex, in the fan around one of them; none where these are many.
  std::vector<uint32_t> edges_around(uint32_t v, uint32_t first) const {
    std::vector<uint32_t> around{first};
    for (size_t i = 0; i < around.size(); ++i) {
      if (around.size() > kMostAround) return {};
      if (!edges_.is_inner(around[i])) continue;
      for (const uint32_t face : edges_.edges[around[i]].face)
        for (const uint32_t e : edges_.of_triangle[face]) {
          const auto& end = edges_.edges[e].end;
          if ((end[0] == v || end[1] == v) && std::find(around.begin(), around.end(), e) == around.end())
            around.push_back(e);
        }
    }
    around.erase(std::remove_if(around.begin(), around.end(), [&](uint32_t e) { return !edges_.is_inner(e); }),
                 around.end());
    return around;
  }

  std::vector<uint32_t> way_on(const FreeEnd& end) const {
    Steps steps{{end.vertex, {0, end.edge, kNone}}};
    std::priority_queue<std::pair<double, uint32_t>, std::vector<std::pair<double, uint32_t>>, std::greater<>> queue;
    for (queue.push({0, end.vertex}); !queue.empty() && steps.size() < kMostSteps;) {
      const auto [so_far, v] = queue.top();
      queue.pop();
      if (std::exchange(steps.at(v).is_done, true)) continue;
      if (is_goal(end, v)) return way_to(v, steps);
      for (const uint32_t e : edges_around(v, steps.at(v).edge)) {
        const uint32_t w = edges_.edges[e].end[0] + edges_.edges[e].end[1] - v;
        const double there = so_far + cost(e);
        if (there > reach_world_ || !is_straight_on(end, w) || is_on_own(end, w)) continue;
        const auto [known, is_new] = steps.try_emplace(w, Step{there, e, v});
        if (!is_new && (known->second.is_done || known->second.cost <= there)) continue;
        known->second = {there, e, v};
        queue.push({there, w});
      }
    }
    return {};
  }

  static std::vector<uint32_t> way_to(uint32_t v, const Steps& steps) {
    std::vector<uint32_t> way;
    for (const Step* step = &steps.at(v); step->from != kNone; step = &steps.at(step->from)) way.push_back(step->edge);
    return way;
  }

  const FeatureMesh& mesh_;
  const MeshEdges& edges_;
  View<const double> turns_;
  const double reach_world_;
  const std::vector<EdgeChain> chains_;
  std::vector<uint32_t> chain_;  ///< per vertex the chain that it is on; kNone: none, kSeveral: an end of several
};

}  // namespace

std::vector<uint32_t> edges_across_gaps(const FeatureMesh& mesh, const MeshEdges& edges, View<const double> turns,
                                        const std::vector<CurveEdge>& curve_edges, double reach_world) {
  return Gaps(mesh, edges, turns, curve_edges, reach_world).edges_across();
}

}  // namespace isoshell
