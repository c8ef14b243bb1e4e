#include "features/curves/edge_chains.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <utility>

#include "geometry/world_vector.h"

namespace isoshell {
namespace {

/// The curve edges at every vertex that has some.
class CurveGraph {
 public:
  CurveGraph(const MeshEdges& edges, const std::vector<CurveEdge>& curve_edges)
      : edges_(edges), curve_edges_(curve_edges), is_taken_(curve_edges.size(), 0) {
    for (uint32_t i = 0; i < curve_edges.size(); ++i)
      for (const uint32_t v : edges.edges[curve_edges[i].edge].end) at_.push_back({v, i});
    tbb::parallel_sort(at_.begin(), at_.end());
    around_.resize(at_.size());
    for (size_t begin = 0, end = 0; begin < at_.size(); begin = end) {
      while (end < at_.size() && at_[end].first == at_[begin].first) ++end;
      for (size_t i = begin; i < end; ++i)
        around_[place(at_[i].first, at_[i].second)] = {uint32_t(begin), uint32_t(end)};
    }
  }

  std::vector<EdgeChain> chains() {
    std::vector<EdgeChain> found;
    for (size_t i = 0; i < at_.size(); ++i)
      if (is_end(at_[i].first, at_[i].second) && !is_taken_[at_[i].second]) found.push_back(chain_from(at_[i], false));
    for (size_t i = 0; i < at_.size(); ++i)
      if (!is_taken_[at_[i].second]) found.push_back(chain_from(at_[i], true));
    const auto smallest = [](const EdgeChain& c) { return *std::min_element(c.edge.begin(), c.edge.end()); };
    std::sort(found.begin(), found.end(),
              [&](const EdgeChain& a, const EdgeChain& b) { return smallest(a) < smallest(b); });
    return found;
  }

 private:
  using Incidence = std::pair<uint32_t, uint32_t>;  // vertex, place among the curve edges

  /// Of the end of a curve edge, which is a vertex.
  size_t place(uint32_t vertex, uint32_t i) const {
    return 2 * size_t(i) + (edges_.edges[curve_edges_[i].edge].end[0] == vertex ? 0 : 1);
  }
  /// What is at a vertex of a curve edge.
  std::pair<const Incidence*, const Incidence*> around(uint32_t vertex, uint32_t i) const {
    const auto& [begin, end] = around_[place(vertex, i)];
    return {at_.data() + begin, at_.data() + end};
  }
  uint32_t degree(uint32_t vertex, uint32_t i) const {
    const auto [begin, end] = around(vertex, i);
    return uint32_t(end - begin);
  }
  bool is_end(uint32_t vertex, uint32_t i) const {
    const auto [begin, end] = around(vertex, i);
    return end - begin != 2 || curve_edges_[begin[0].second].kind != curve_edges_[begin[1].second].kind;
  }

  EdgeChain chain_from(const Incidence& start, bool is_ring) {
    EdgeChain chain{curve_edges_[start.second].kind, is_ring, 0, {}, {start.first}, {}};
    uint32_t at = start.first, i = start.second;
    for (;;) {
      is_taken_[i] = 1;
      const uint32_t edge = curve_edges_[i].edge;
      const auto& end = edges_.edges[edge].end;
      at = end[0] == at ? end[1] : end[0];
      chain.edge.push_back(edge);
      chain.turn += curve_edges_[i].turn;
      chain.vertex.push_back(at);
      if (is_ring ? at == start.first : is_end(at, i)) break;
      const Incidence* const two = around(at, i).first;
      i = two[0].second == i ? two[1].second : two[0].second;
    }
    chain.turn /= double(chain.edge.size());
    chain.degree = {degree(start.first, start.second), degree(at, i)};
    return chain;
  }

  const MeshEdges& edges_;
  const std::vector<CurveEdge>& curve_edges_;
  std::vector<Incidence> at_;                          // ascending
  std::vector<std::pair<uint32_t, uint32_t>> around_;  // per end of a curve edge: what is at its vertex, in at_
  std::vector<uint8_t> is_taken_;
};

}  // namespace

std::vector<EdgeChain> find_chains(const MeshEdges& edges, const std::vector<CurveEdge>& curve_edges) {
  return CurveGraph(edges, curve_edges).chains();
}

double length_of(const FeatureMesh& mesh, const EdgeChain& chain) {
  double sum = 0;
  for (size_t i = 0; i + 1 < chain.vertex.size(); ++i)
    sum += length(mesh.vertices[chain.vertex[i + 1]] - mesh.vertices[chain.vertex[i]]);
  return sum;
}

}  // namespace isoshell
