#include "features/curves/find_curves.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <utility>

#include "core/parallel_ranges.h"
#include "features/curves/corners.h"
#include "features/curves/creases.h"
#include "features/curves/small_creases.h"
#include "isoshell/error.h"

namespace isoshell {
namespace {

void check(const CurveOptions& options) {
  const double h = options.edge_length_world;
  if (!(h > 0) || !std::isfinite(h))
    throw Error(ErrorCode::usage, "features",
                "curves are looked for at an edge length of " + std::to_string(h) + "; give one above 0");
  if (options.mode == CreaseMode::threshold && !(options.degrees > 0 && options.degrees <= 180))
    throw Error(ErrorCode::usage, "features",
                "creases are edges that turn by " + std::to_string(options.degrees) +
                    " degrees or more; give an angle above 0 and at most 180");
}

/// Those that are inner edges of the mesh, ascending.
std::vector<uint32_t> inner_edges(const MeshEdges& edges, const std::vector<std::array<uint32_t, 2>>& ends) {
  std::vector<uint32_t> found;
  for (auto [a, b] : ends) {
    if (b < a) std::swap(a, b);
    const auto at =
        std::lower_bound(edges.edges.begin(), edges.edges.end(), std::array<uint32_t, 2>{a, b},
                         [](const FeatureEdge& e, const std::array<uint32_t, 2>& end) { return e.end < end; });
    if (at != edges.edges.end() && at->end == std::array<uint32_t, 2>{a, b} && at->use == EdgeUse::inner)
      found.push_back(uint32_t(at - edges.edges.begin()));
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

/// Creases on what is added take its kind and remember their turn: nothing drops them.
std::vector<CurveEdge> with_edges(const std::vector<CurveEdge>& curve_edges, const std::vector<uint32_t>& added,
                                  CurveKind kind) {
  std::vector<CurveEdge> all;
  auto next = curve_edges.begin();
  for (const uint32_t e : added) {
    for (; next != curve_edges.end() && next->edge < e; ++next) all.push_back(*next);
    const bool is_crease = next != curve_edges.end() && next->edge == e;
    all.push_back({e, kind, is_crease ? next++->turn : 0});
  }
  all.insert(all.end(), next, curve_edges.end());
  return all;
}

std::vector<CurveEdge> without_creases_at(std::vector<CurveEdge> curve_edges, const std::vector<uint32_t>& smooth) {
  const auto is_smooth = [&](const CurveEdge& c) {
    return c.kind == CurveKind::crease && std::binary_search(smooth.begin(), smooth.end(), c.edge);
  };
  curve_edges.erase(std::remove_if(curve_edges.begin(), curve_edges.end(), is_smooth), curve_edges.end());
  return curve_edges;
}

std::vector<CurveEdge> find_curve_edges(const FeatureMesh& mesh, const MeshEdges& edges, std::vector<CurveEdge> found,
                                        const CurveOptions& options) {
  if (!options.smooth.empty()) found = without_creases_at(std::move(found), inner_edges(edges, options.smooth));
  if (!options.lines.empty()) found = with_edges(found, inner_edges(edges, options.lines), CurveKind::line);
  if (!options.seams.empty()) found = with_edges(found, inner_edges(edges, options.seams), CurveKind::seam);
  if (options.most_vertices == 0 && !options.interfaces.empty())
    found = with_edges(found, inner_edges(edges, options.interfaces), CurveKind::line);
  if (options.mode != CreaseMode::off)
    found = drop_small_creases(mesh, edges, std::move(found), options.edge_length_world);
  if (options.most_vertices > 0)
    found = drop_least_creases(mesh, edges, std::move(found), options.edge_length_world, options.most_vertices);
  for (CurveEdge& c : found)
    if ((c.kind == CurveKind::seam || c.kind == CurveKind::line) && c.turn > 0) c.kind = CurveKind::crease;
  return found;
}

/// A curve, and its smallest edge, which it is sorted by.
struct NumberedCurve {
  uint32_t smallest_edge;
  FeatureCurve curve;
};

/// The edges from one place of a chain to another, which may lie behind a ring's end.
NumberedCurve curve_between(const EdgeChain& chain, size_t begin, size_t end) {
  NumberedCurve made{UINT32_MAX, {chain.kind, false, {}}};
  uint32_t first_edge = 0, last_edge = 0;
  for (size_t i = begin; i < end; ++i) {
    last_edge = chain.edge[i % chain.edge.size()];
    if (i == begin) first_edge = last_edge;
    made.smallest_edge = std::min(made.smallest_edge, last_edge);
    made.curve.vertex.push_back(chain.vertex[i % chain.edge.size()]);
  }
  made.curve.vertex.push_back(chain.vertex[(end - 1) % chain.edge.size() + 1]);
  auto& v = made.curve.vertex;
  if (v.back() < v.front() || (v.back() == v.front() && last_edge < first_edge)) std::reverse(v.begin(), v.end());
  return made;
}

std::vector<NumberedCurve> cut_at_corners(const FeatureMesh& mesh, const EdgeChain& chain, double edge_length_world) {
  std::vector<size_t> places = corners_inside(mesh, chain, edge_length_world);
  std::vector<NumberedCurve> curves;
  if (chain.is_ring && places.empty()) {
    curves.push_back({*std::min_element(chain.edge.begin(), chain.edge.end()), {chain.kind, true, chain.vertex}});
    curves.back().curve.vertex.pop_back();
    return curves;
  }
  if (chain.is_ring)
    places.push_back(places.front() + chain.edge.size());
  else {
    places.insert(places.begin(), 0);
    places.push_back(chain.edge.size());
  }
  for (size_t i = 0; i + 1 < places.size(); ++i) curves.push_back(curve_between(chain, places[i], places[i + 1]));
  return curves;
}

}  // namespace

FoundCreases find_creases(const FeatureMesh& mesh, const CurveOptions& options) {
  check(options);
  FoundCreases found;
  found.edges = find_mesh_edges(mesh);
  const MeshEdges& edges = found.edges;
  std::vector<CurveEdge>& all = found.curve_edges;
  all = find_fixed_curve_edges(edges);
  if (options.mode == CreaseMode::threshold) all = with_creases_above(mesh, edges, all, options.degrees);
  if (options.mode == CreaseMode::automatic) all = with_creases_beside_smooth(mesh, edges, all, options, found.report);
  if (options.mode == CreaseMode::given) all = with_creases_at(mesh, edges, all, inner_edges(edges, options.creases));
  return found;
}

CurveNetwork find_curves(const FeatureMesh& mesh, const CurveOptions& options, CreaseReport* report) {
  return find_curves(mesh, options, find_creases(mesh, options), report);
}

CurveNetwork find_curves(const FeatureMesh& mesh, const CurveOptions& options, const FoundCreases& found,
                         CreaseReport* report) {
  const MeshEdges& edges = found.edges;
  const std::vector<EdgeChain> chains = find_chains(edges, find_curve_edges(mesh, edges, found.curve_edges, options));

  std::vector<std::vector<NumberedCurve>> cut(chains.size());
  for_each_index(size_t(0), chains.size(),
                 [&](size_t c) { cut[c] = cut_at_corners(mesh, chains[c], options.edge_length_world); });
  std::vector<NumberedCurve> all;
  for (auto& curves : cut) std::move(curves.begin(), curves.end(), std::back_inserter(all));
  std::sort(all.begin(), all.end(),
            [](const NumberedCurve& a, const NumberedCurve& b) { return a.smallest_edge < b.smallest_edge; });

  CurveNetwork network;
  for (NumberedCurve& c : all) {
    if (!c.curve.is_loop)
      network.corners.insert(network.corners.end(), {c.curve.vertex.front(), c.curve.vertex.back()});
    network.curves.push_back(std::move(c.curve));
  }
  std::sort(network.corners.begin(), network.corners.end());
  network.corners.erase(std::unique(network.corners.begin(), network.corners.end()), network.corners.end());
  if (!report) return network;
  *report = found.report;
  for (const EdgeChain& chain : chains)
    if (chain.kind == CurveKind::crease) report->kept_length_world += length_of(mesh, chain);
  return network;
}

}  // namespace isoshell
