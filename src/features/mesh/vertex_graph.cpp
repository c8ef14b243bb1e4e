// find_vertex_graph (see vertex_graph.h).
#include "features/mesh/vertex_graph.h"

#include "geometry/world_vector.h"

namespace isoshell {

VertexGraph find_vertex_graph(const FineMesh& mesh) {
  const auto vertices = int64_t(mesh.position.size());
  VertexGraph graph;
  graph.neighbours =
      without_repeats(sort_into_buckets<uint32_t>(vertices, int64_t(mesh.triangles.size()), [&](int64_t t, auto put) {
        const auto& [a, b, c] = mesh.triangles[size_t(t)];
        for (const auto& [u, v] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) put(u, v), put(v, u);
      }));
  graph.way.resize(size_t(graph.neighbours.items.size()));
  for_each_index(int64_t(0), vertices, [&](int64_t v) {
    for (int64_t i = graph.neighbours.first[v]; i < graph.neighbours.first[v + 1]; ++i)
      graph.way[size_t(i)] = length(mesh.position[graph.neighbours.items[i]] - mesh.position[size_t(v)]);
  });
  return graph;
}

}  // namespace isoshell
