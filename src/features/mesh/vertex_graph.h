// The vertices of a fine mesh that its edges join.
#pragma once

#include <algorithm>
#include <utility>

#include "core/buckets.h"
#include "core/parallel_ranges.h"
#include "features/mesh/refine_mesh.h"

namespace isoshell {

struct VertexGraph {
  Buckets<uint32_t> neighbours;  ///< per vertex, ascending
  std::vector<double> way;       ///< to each of them: the length of the edge

  /// Calls visit(neighbour, way) for each.
  template <class Visit>
  void for_each(int64_t vertex, Visit visit) const {
    for (int64_t i = neighbours.first[vertex]; i < neighbours.first[vertex + 1]; ++i)
      visit(neighbours.items[i], way[size_t(i)]);
  }
};

VertexGraph find_vertex_graph(const FineMesh& mesh);

/// The least values that a graph allows: each vertex has its own, or what `step` makes of a neighbour's and the way
/// from there where that is less. A step along a way makes no value less. In rounds, each of which looks at what has
/// more than a neighbour offers that changed, or has what that offered before; what comes out is the same as that of a
/// search from the least value on.
template <class Value, class Step>
std::vector<Value> least_values(const VertexGraph& graph, const std::vector<Value>& own, Step step) {
  const auto vertices = uint32_t(own.size());
  std::vector<Value> value = own, pulled = own;
  Buffer<uint32_t> looked_at(vertices), next(vertices);
  std::vector<uint32_t> stamp(vertices, 0);
  for_each_index(uint32_t(0), vertices, [&](uint32_t v) { looked_at[v] = v; });
  for (uint32_t count = vertices, round = 1; count > 0; ++round) {
    for_each_index(uint32_t(0), count, [&](uint32_t i) {
      const uint32_t v = looked_at[i];
      Value least = own[v];
      graph.for_each(v, [&](uint32_t u, double way) { least = std::min(least, step(value[u], way)); });
      pulled[v] = least;
    });
    uint32_t listed = 0;
    for_each_index(uint32_t(0), count, [&](uint32_t i) {
      const uint32_t v = looked_at[i];
      if (pulled[v] == value[v]) return;
      graph.for_each(v, [&](uint32_t u, double way) {
        const bool may_change = step(pulled[v], way) < pulled[u] || step(value[v], way) == pulled[u];
        if (may_change && atomic_load(stamp[u]) < round && atomic_max(stamp[u], round))
          next[__atomic_fetch_add(&listed, 1, __ATOMIC_RELAXED)] = u;
      });
      value[v] = pulled[v];
    });
    std::swap(looked_at, next);
    count = listed;
  }
  return value;
}

}  // namespace isoshell
