// separate_fans and count_separated_places (see separate_fans.h).
#include "features/mesh/separate_fans.h"

#include <algorithm>
#include <utility>

#include "features/mesh/curve_paths.h"

namespace isoshell {
namespace {

/// Keys of the edges of one triangle, ascending.
std::vector<uint64_t> border_edges_of(const MeshTriangles& triangles, size_t vertices) {
  const EdgeSides sides = find_edge_sides(triangles, vertices);
  std::vector<uint64_t> borders;
  for_each_edge(sides, [&](uint32_t u, uint32_t v, View<const EdgeSide> on_edge) {
    if (on_edge.size == 1) borders.push_back(edge_key(u, v));
  });
  return borders;
}

}  // namespace

std::vector<uint32_t> separate_fans(std::vector<WorldPoint>& position, MeshTriangles& triangles) {
  const MeshFans fans = find_fans(triangles, int64_t(position.size()), border_edges_of(triangles, position.size()));
  std::vector<uint32_t> separated, vertex_of_fan(fans.vertex.size());
  std::vector<char> is_taken(position.size(), 0);
  for (size_t f = 0; f < fans.vertex.size(); ++f) {
    const uint32_t v = fans.vertex[f];
    vertex_of_fan[f] = is_taken[v] ? uint32_t(position.size()) : v;
    if (is_taken[v]) {
      position.push_back(WorldPoint(position[v]));
      separated.push_back(v);
    }
    is_taken[v] = 1;
  }
  for (size_t c = 0; c < fans.of_corner.size(); ++c) triangles[c / 3][c % 3] = vertex_of_fan[fans.of_corner[c]];
  return separated;
}

int64_t count_separated_places(const FeatureMesh& mesh, const CurveNetwork& network, const MeshTriangles& separated) {
  std::vector<uint64_t> curve_edges;
  for (const FeatureCurve& curve : network.curves) append_edges(curve, curve_edges);
  std::sort(curve_edges.begin(), curve_edges.end());
  std::vector<std::pair<uint32_t, uint32_t>> vertices;  // as they were and as they are
  for (size_t t = 0; t < separated.size(); ++t)
    for (size_t i = 0; i < 3; ++i) {
      const auto &was = mesh.triangles[t], &is = separated[t];
      const size_t j = (i + 1) % 3;
      if (!std::binary_search(curve_edges.begin(), curve_edges.end(), edge_key(was[i], was[j]))) continue;
      vertices.insert(vertices.end(), {{was[i], is[i]}, {was[j], is[j]}});
    }
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  int64_t more = 0;
  for (size_t i = 1; i < vertices.size(); ++i) more += vertices[i].first == vertices[i - 1].first ? 1 : 0;
  return more;
}

}  // namespace isoshell
