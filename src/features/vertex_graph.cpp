// find_vertex_graph (see vertex_graph.h).
#include "features/vertex_graph.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>

namespace isoshell {

VertexGraph find_vertex_graph(const MeshTriangles& triangles, size_t vertices) {
  std::vector<uint64_t> pairs(6 * triangles.size());
  tbb::parallel_for(size_t(0), triangles.size(), [&](size_t t) {
    for (size_t i = 0; i < 3; ++i) {
      const uint64_t u = triangles[t][i], v = triangles[t][(i + 1) % 3];
      pairs[6 * t + 2 * i] = u << 32 | v;
      pairs[6 * t + 2 * i + 1] = v << 32 | u;
    }
  });
  tbb::parallel_sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  VertexGraph graph;
  graph.first.assign(vertices + 1, 0);
  graph.neighbour.reserve(pairs.size());
  for (const uint64_t pair : pairs) {
    ++graph.first[(pair >> 32) + 1];
    graph.neighbour.push_back(uint32_t(pair));
  }
  for (size_t v = 0; v < vertices; ++v) graph.first[v + 1] += graph.first[v];
  return graph;
}

}  // namespace isoshell
