#include "features/curves/creases.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <map>
#include <utility>

#include "core/parallel_ranges.h"
#include "features/curves/crease_gaps.h"
#include "features/curves/creases_before.h"
#include "features/curves/face_normals.h"
#include "features/curves/facet_edges.h"
#include "features/curves/surface_walk.h"

namespace isoshell {
namespace {

constexpr double kSeedDegrees = 40, kGrowthDegrees = 20;
constexpr double kStraightOn = .5;         // cosine between an edge and the next one, to grow: 60 degrees
constexpr int64_t kMostToGrow = 64;        // edges around a vertex: where more meet, none goes on from another
constexpr double kMostBeside = .51;        // of a good chain; one side may turn, however much, when the other is flat
constexpr double kMostBesideInPart = .75;  // of a crease of a component that has creases: both sides may be round
constexpr double kLeastGoodShare = .75;  // of a component that has creases: crisp parts have .76 to 1, scans up to .62
constexpr double kLong = 4;  // a long chain has so many edges of the input, and is as long as so many of the result
constexpr double kStrongDegrees = 70;      // a strong chain is long, and turns so much in the mean between flat sides
constexpr double kMostBesideStrong = .35;  // of a strong chain
constexpr double kLeastStrongShare = .15;  // of a component that has creases: scans have up to .1, thin round parts .25
constexpr double kNearlyAll = .98;         // crisp parts have 1, a pool with a rim .72 to .95 when a drop falls into it
constexpr size_t kParts = 12;              // in which chains are judged
constexpr double kWalkInFaceSizes = 4;     // at least: roots of the area of the face beside the edge

/// 1 - the cosine that the normals of an edge's triangles turn by; 0 off inner edges.
Buffer<double> turns_at(const MeshEdges& edges, View<const WorldPoint> normals) {
  Buffer<double> turns(edges.count());
  for_each_index(uint32_t(0), edges.count(), [&](uint32_t e) {
    const auto& face = edges.edges[e].face;
    turns[e] = edges.is_inner(e) ? turn_between(normals[face[0]], normals[face[1]]) : 0;
  });
  return turns;
}

std::vector<uint32_t> edges_above(View<const double> turns, double least) {
  std::vector<uint32_t> found;
  for (uint32_t e = 0; e < turns.size; ++e)
    if (turns[e] >= least) found.push_back(e);
  return found;
}

/// Whether edge `to` goes on from edge `from` at their common vertex.
bool goes_on(const FeatureMesh& mesh, const FeatureEdge& from, const FeatureEdge& to, uint32_t at) {
  const auto away = [&](const FeatureEdge& e) { return mesh.vertices[e.end[0] + e.end[1] - at] - mesh.vertices[at]; };
  const WorldPoint a = away(from), b = away(to);
  return -dot(a, b) >= kStraightOn * std::sqrt(length_sq(a) * length_sq(b));
}

/// Fixed curve edges and creases in one list, ascending.
std::vector<CurveEdge> with_creases(const std::vector<CurveEdge>& fixed, const std::vector<uint32_t>& creases,
                                    View<const double> turns) {
  std::vector<CurveEdge> both;
  auto next = fixed.begin();
  for (const uint32_t e : creases) {
    for (; next != fixed.end() && next->edge < e; ++next) both.push_back(*next);
    both.push_back({e, CurveKind::crease, turns[e]});
  }
  both.insert(both.end(), next, fixed.end());
  return both;
}

/// Hysteresis: sharp edges, and less sharp ones that go on from a crease.
std::vector<uint32_t> grow_creases(const FeatureMesh& mesh, const MeshEdges& edges, View<const double> turns) {
  const std::vector<uint32_t> weak = edges_above(turns, turn_of_degrees(kGrowthDegrees));
  std::vector<std::pair<uint32_t, uint32_t>> around;  // vertex, edge
  for (const uint32_t e : weak)
    for (const uint32_t v : edges.edges[e].end) around.push_back({v, e});
  tbb::parallel_sort(around.begin(), around.end());

  std::vector<uint8_t> is_crease(edges.count(), 0);
  std::vector<uint32_t> grown = edges_above(turns, turn_of_degrees(kSeedDegrees));
  for (const uint32_t e : grown) is_crease[e] = 1;
  for (size_t i = 0; i < grown.size(); ++i) {
    const FeatureEdge from = edges.edges[grown[i]];
    for (const uint32_t v : from.end) {
      const auto begin = std::lower_bound(around.begin(), around.end(), std::pair(v, 0u));
      const auto end = std::upper_bound(begin, around.end(), std::pair(v, UINT32_MAX));
      if (end - begin > kMostToGrow) continue;
      for (auto at = begin; at != end; ++at) {
        if (is_crease[at->second] || !goes_on(mesh, from, edges.edges[at->second], v)) continue;
        is_crease[at->second] = 1;
        grown.push_back(at->second);
      }
    }
  }
  std::sort(grown.begin(), grown.end());
  return grown;
}

/// A chain of creases, judged.
struct Judged {
  uint32_t component = 0;
  double length_world = 0;
  /// How much the surface turns beside the chain over how much at it, in roots of 1 - cosine, a side as much as the
  /// edge at most; before one has looked, as much as the edge.
  double beside = 1;
  double unseen = 0;  ///< the same of sides that are a single small triangle, as if that turned like the edge
  bool is_long = false, is_sharp = false;
  bool is_bad() const { return beside >= kMostBeside; }
  /// A triangle between creases says nothing of a surface.
  bool is_surely_good() const { return beside + unseen < kMostBeside; }
  bool is_strong() const { return is_long && is_sharp && beside + unseen < kMostBesideStrong; }
};

/// Of the chains of a component. Those that are neither good nor bad say nothing, if they are not the most. A part with
/// a rough or twisted place has some strong ones, a scan hardly any.
struct Lengths {
  double all = 0, good = 0, bad = 0, strong = 0;
  double may_be_strong = 0;  ///< of long ones that one has not looked at yet
  void add(const Judged& chain) {
    all += chain.length_world;
    may_be_strong += chain.is_long ? chain.length_world : 0;
  }
  void add_judged(const Judged& chain, bool is_bad) {
    may_be_strong -= chain.is_long ? chain.length_world : 0;
    strong += chain.is_strong() ? chain.length_world : 0;
    good += chain.is_surely_good() ? chain.length_world : 0;
    bad += is_bad ? chain.length_world : 0;
  }
  bool are_mostly_good() const { return good >= kLeastGoodShare * (good + bad) && 2 * good >= all; }
  bool are_of_creases() const { return are_mostly_good() || strong >= kLeastStrongShare * all; }
  /// Whatever the chains are that one has not looked at yet, and however sums are rounded.
  bool are_surely_of_a_scan() const {
    return bad > 1.001 * (1 - kLeastGoodShare) * all && 1.001 * (strong + may_be_strong) < kLeastStrongShare * all;
  }
};

/// All chains, and the sums of each component that has creases.
struct JudgedChains {
  std::vector<Judged> chain;
  std::map<uint32_t, Lengths> of_component;

  /// Where strong chains alone tell that a component has creases, short ones with a round side may be of a rough place.
  bool is_crease(size_t c) const {
    const Lengths& lengths = of_component.at(chain[c].component);
    return chain[c].beside < kMostBesideInPart && lengths.are_of_creases() &&
           (lengths.are_mostly_good() || chain[c].is_long || chain[c].is_surely_good());
  }
  /// Whether nearly all that looks like a crease is one, over all components.
  bool are_nearly_all_creases() const {
    double all = 0, good = 0;
    for (const auto& [component, lengths] : of_component) all += lengths.all, good += lengths.good;
    return good >= kNearlyAll * all;
  }
};

/// Looks beside creases at the surface as it is: what filtered normals hide tells a scan.
class Judge {
 public:
  Judge(const FeatureMesh& mesh, const MeshEdges& edges, View<const WorldPoint> normals,
        View<const double> filtered_turns, const std::vector<EdgeChain>& chains, double reach_world)
      : mesh_(mesh),
        edges_(edges),
        normals_(normals),
        turns_(filtered_turns),
        chains_(chains),
        is_end_(edges.count(), 0),
        component_(components_of(mesh, edges)),
        reach_world_(reach_world) {
    for (const EdgeChain& chain : chains)
      for (const uint32_t e : chain.edge) is_end_[e] = 1;
  }

  /// Looks at every twelfth chain, then at the next ones of components that may have creases: on a scan, it needs no
  /// more than show that a quarter of their length is bad, and that too few are long. Beside creases before all are bad
  /// that these do not hold, or that say nothing, and the surface is one component.
  JudgedChains judge(const CreasesBefore* before) const {
    const WalkGround ground{mesh_, edges_, normals_, is_end_};
    JudgedChains all{std::vector<Judged>(chains_.size()), {}};
    std::vector<Judged>& judged = all.chain;
    std::map<uint32_t, Lengths>& of_component = all.of_component;
    for (size_t c = 0; c < chains_.size(); ++c) {
      if (chains_[c].kind != CurveKind::crease) continue;
      judged[c] = {before ? 0 : component_[edges_.edges[chains_[c].edge[0]].face[0]], length_of(mesh_, chains_[c])};
      // In a frame that follows another, strong chains do not count: the rim of a pool would come and go with drops.
      judged[c].is_long =
          !before && judged[c].length_world >= kLong * reach_world_ && double(chains_[c].edge.size()) >= kLong;
      of_component[judged[c].component].add(judged[c]);
    }
    for (size_t first = 0; first < kParts; ++first) {
      for_each_index(size_t(0), (chains_.size() + kParts - 1 - first) / kParts, [&](size_t i) {
        const size_t c = first + kParts * i;
        if (chains_[c].kind == CurveKind::crease && !of_component.at(judged[c].component).are_surely_of_a_scan() &&
            (!before || before->hold(mesh_, chains_[c])))
          look_beside_chain(ground, chains_[c], judged[c]);
      });
      for (size_t c = first; c < chains_.size(); c += kParts)
        if (chains_[c].kind == CurveKind::crease)
          of_component[judged[c].component].add_judged(judged[c],
                                                       before ? !judged[c].is_surely_good() : judged[c].is_bad());
    }
    return all;
  }

 private:
  void look_beside_chain(const WalkGround& ground, const EdgeChain& chain, Judged& judged) const {
    double beside = 0, unseen = 0, at = 0;
    const auto size = [&](size_t i) {
      return length(mesh_.vertices[chain.vertex[i + 1]] - mesh_.vertices[chain.vertex[i]]);
    };
    for (size_t i = 0; i < chain.edge.size(); ++i) at += size(i) * std::sqrt(turns_[chain.edge[i]]);
    judged.is_sharp = at >= judged.length_world * std::sqrt(turn_of_degrees(kStrongDegrees));
    // Sums only grow: what is found to be no crease on the way needs no more walks.
    for (size_t i = 0; i < chain.edge.size() && beside / at < kMostBesideInPart; ++i) {
      const uint32_t e = chain.edge[i];
      const double own = std::sqrt(turns_[e]);
      for (const uint32_t f : edges_.edges[e].face) {
        const BesideEdge seen = look_beside(ground, e, f, walk_length(f));
        beside += size(i) / 2 * std::min(std::sqrt(seen.turn), own);
        const bool is_seen = seen.crossed > 0 || seen.walked_world >= reach_world_;
        if (!is_seen) unseen += size(i) / 2 * own;
      }
    }
    judged.beside = beside / at;
    judged.unseen = unseen / at;
  }

  double walk_length(uint32_t face) const {
    const auto& c = mesh_.triangles[face];
    const double area = triangle_area(mesh_.vertices[c[0]], mesh_.vertices[c[1]], mesh_.vertices[c[2]]);
    return std::max(reach_world_, kWalkInFaceSizes * std::sqrt(area));
  }

  const FeatureMesh& mesh_;
  const MeshEdges& edges_;
  View<const WorldPoint> normals_;
  View<const double> turns_;
  const std::vector<EdgeChain>& chains_;
  std::vector<uint8_t> is_end_;      ///< per edge: a chain's, where walks end
  std::vector<uint32_t> component_;  ///< per triangle
  double reach_world_;
};

}  // namespace

std::vector<CurveEdge> find_fixed_curve_edges(const MeshEdges& edges) {
  std::vector<CurveEdge> fixed;
  for (uint32_t e = 0; e < edges.count(); ++e)
    if (!edges.is_inner(e))
      fixed.push_back({e, edges.edges[e].use == EdgeUse::border ? CurveKind::border : CurveKind::non_manifold, 0});
  return fixed;
}

std::vector<CurveEdge> with_creases_above(const FeatureMesh& mesh, const MeshEdges& edges,
                                          const std::vector<CurveEdge>& fixed, double degrees) {
  const Buffer<double> turns = turns_at(edges, face_normals(mesh, edges).view());
  return with_creases(fixed, edges_above(turns.view(), turn_of_degrees(degrees)), turns.view());
}

std::vector<CurveEdge> with_creases_at(const FeatureMesh& mesh, const MeshEdges& edges,
                                       const std::vector<CurveEdge>& fixed, const std::vector<uint32_t>& creases) {
  const Buffer<double> turns = turns_at(edges, face_normals(mesh, edges).view());
  return with_creases(fixed, creases, turns.view());
}

std::vector<CurveEdge> with_creases_beside_smooth(const FeatureMesh& mesh, const MeshEdges& edges,
                                                  const std::vector<CurveEdge>& fixed, const CurveOptions& options,
                                                  CreaseReport& report) {
  const double edge_length_world = options.edge_length_world;
  const Buffer<WorldPoint> face_normal = face_normals(mesh, edges);
  const View<const WorldPoint> normals = face_normal.view();
  const Buffer<double> turn = turns_at(edges, filter_normals(mesh, edges, normals, edge_length_world).view());
  const View<const double> turns = turn.view();
  const std::vector<uint32_t> candidates = grow_creases(mesh, edges, turns);
  if (candidates.empty()) return fixed;
  const std::vector<EdgeChain> chains = find_chains(edges, with_creases(fixed, candidates, turns));
  const Judge judge(mesh, edges, normals, turns, chains, edge_length_world);
  JudgedChains judged = judge.judge(nullptr);
  if (options.before && !judged.are_nearly_all_creases()) {
    const CreasesBefore before(*options.before, edge_length_world);
    judged = judge.judge(&before);
  }
  std::vector<uint32_t> kept;
  for (size_t c = 0; c < chains.size(); ++c)
    if (chains[c].kind == CurveKind::crease && judged.is_crease(c))
      kept.insert(kept.end(), chains[c].edge.begin(), chains[c].edge.end());
  std::sort(kept.begin(), kept.end());
  if (!kept.empty()) {
    // Before facets, whose edges end at curves.
    const std::vector<uint32_t> across =
        edges_across_gaps(mesh, edges, turns, with_creases(fixed, kept, turns), edge_length_world);
    kept.insert(kept.end(), across.begin(), across.end());
    std::sort(kept.begin(), kept.end());
    const std::vector<uint32_t> facets =
        find_facet_edges(mesh, edges, normals, with_creases(fixed, kept, turns), edge_length_world);
    kept.insert(kept.end(), facets.begin(), facets.end());
    std::sort(kept.begin(), kept.end());
  }
  for (const auto& [component, lengths] : judged.of_component) {
    report.candidate_length_world += lengths.all;
    report.components_with_candidates += lengths.all > 0;
    report.components_without_creases += lengths.all > 0 && !lengths.are_of_creases();
  }
  return with_creases(fixed, kept, turns);
}

}  // namespace isoshell
