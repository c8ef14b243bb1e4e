// See facet_edges.h.
#include "features/curves/facet_edges.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "core/parallel_ranges.h"
#include "features/curves/face_normals.h"
#include "features/curves/surface_walk.h"

namespace isoshell {
namespace {

constexpr double kLeastDegrees = 4, kFlatDegrees = 0.5;
constexpr double kNarrowCosine = 0.866;
constexpr int64_t kMostAround = 64;   ///< edges around a vertex: more leave less than 30 degrees between them
constexpr double kLeastWidth = 0.85;  ///< of h

/// Per edge whether facets end there: it turns, or a curve is there.
std::vector<uint8_t> find_ends(const MeshEdges& edges, View<const WorldPoint> normals,
                               const std::vector<CurveEdge>& curve_edges) {
  const double least = turn_of_degrees(kLeastDegrees);
  std::vector<uint8_t> is_end(edges.count(), 0);
  for_each_index(size_t(0), is_end.size(), [&](size_t e) {
    const auto& face = edges.edges[e].face;
    is_end[e] = edges.is_inner(uint32_t(e)) && turn_between(normals[face[0]], normals[face[1]]) >= least;
  });
  for (const CurveEdge& c : curve_edges) is_end[c.edge] = 1;
  return is_end;
}

/// Curve edges by their ends.
class EdgesAround {
 public:
  EdgesAround(const MeshEdges& edges, const std::vector<CurveEdge>& curve_edges) : edges_(edges) {
    for (const CurveEdge& c : curve_edges)
      for (const uint32_t v : edges.edges[c.edge].end) around_.push_back({v, c.edge});
    std::sort(around_.begin(), around_.end());
  }

  template <class Is>
  bool any(uint32_t vertex, Is is) const {
    const auto [begin, end] = around(vertex);
    return std::any_of(begin, end, [&](const Incidence& at) { return is(at.second); });
  }

  /// Whether an edge meets another in a vertex so that triangles between them would have an angle less than 30 degrees.
  bool is_narrow(const FeatureMesh& mesh, uint32_t vertex, uint32_t edge) const {
    const auto [begin, end] = around(vertex);
    if (end - begin > kMostAround) return true;
    const WorldPoint along = direction(mesh, vertex, edge);
    return any(vertex, [&](uint32_t other) {
      const WorldPoint o = direction(mesh, vertex, other);
      return other != edge && dot(along, o) > kNarrowCosine * std::sqrt(length_sq(along) * length_sq(o));
    });
  }

 private:
  using Incidence = std::pair<uint32_t, uint32_t>;  // vertex, edge

  std::pair<const Incidence*, const Incidence*> around(uint32_t vertex) const {
    const auto begin = std::lower_bound(around_.begin(), around_.end(), Incidence{vertex, 0});
    const auto end = std::upper_bound(begin, around_.end(), Incidence{vertex, UINT32_MAX});
    return {around_.data() + (begin - around_.begin()), around_.data() + (end - around_.begin())};
  }

  WorldPoint direction(const FeatureMesh& mesh, uint32_t from, uint32_t edge) const {
    const auto& end = edges_.edges[edge].end;
    return mesh.vertices[end[0] == from ? end[1] : end[0]] - mesh.vertices[from];
  }

  const MeshEdges& edges_;
  std::vector<Incidence> around_;
};

}  // namespace

std::vector<uint32_t> find_facet_edges(const FeatureMesh& mesh, const MeshEdges& edges, View<const WorldPoint> normals,
                                       const std::vector<CurveEdge>& curve_edges, double edge_length_world) {
  const std::vector<uint8_t> is_end = find_ends(edges, normals, curve_edges);
  std::vector<uint8_t> is_candidate = is_end;
  for (const CurveEdge& c : curve_edges) is_candidate[c.edge] = 0;
  const WalkGround ground{mesh, edges, normals, is_end};
  const double width = kLeastWidth * edge_length_world, flat = turn_of_degrees(kFlatDegrees);
  for_each_index(uint32_t(0), edges.count(), [&](uint32_t e) {
    for (const uint32_t f : edges.edges[e].face) {
      if (!is_candidate[e]) return;
      const BesideEdge seen = look_beside(ground, e, f, width);
      is_candidate[e] = seen.turn <= flat && seen.walked_world >= width;
    }
  });

  std::vector<CurveEdge> all = curve_edges;
  for (uint32_t e = 0; e < edges.count(); ++e)
    if (is_candidate[e]) all.push_back({e, CurveKind::crease, 0});
  std::sort(all.begin(), all.end(), [](const CurveEdge& a, const CurveEdge& b) { return a.edge < b.edge; });
  const EdgesAround around(edges, all);
  const auto is_curve = [&](uint32_t e) { return !is_candidate[e]; };
  std::vector<uint32_t> found;
  for (const EdgeChain& chain : find_chains(edges, all)) {
    if (!is_candidate[chain.edge[0]]) continue;
    const bool is_between = around.any(chain.vertex.front(), is_curve) && around.any(chain.vertex.back(), is_curve) &&
                            !around.is_narrow(mesh, chain.vertex.front(), chain.edge.front()) &&
                            !around.is_narrow(mesh, chain.vertex.back(), chain.edge.back());
    if (!chain.is_ring && !is_between) continue;
    // A crease may end within a chain, where edges that turn less go on from it.
    std::copy_if(chain.edge.begin(), chain.edge.end(), std::back_inserter(found),
                 [&](uint32_t e) { return is_candidate[e]; });
  }
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace isoshell
