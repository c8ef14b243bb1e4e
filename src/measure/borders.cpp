#include "isoshell/borders.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/index_sets.h"
#include "core/parallel_ranges.h"
#include "core/watched.h"
#include "geometry/half_edges.h"
#include "geometry/triangle_grid.h"
#include "geometry/triangle_list.h"
#include "geometry/world_vector.h"

namespace isoshell {
namespace {

struct Borders {
  std::vector<std::array<uint32_t, 3>> segments;  ///< triangles without area, which a grid of triangles takes
  std::vector<uint32_t> vertices;
  int64_t loops = 0;
  double length_world = 0;
};

/// Corners are joined over edges of two triangles, to fans, and along border edges: each set is a loop then.
Borders borders_of(const TriangleMesh& mesh) {
  Borders borders;
  require_indices(mesh.triangles, mesh.vertices.size(), "borders");
  IndexSets loops(int64_t(3 * mesh.triangles.size()));
  const auto corner_at = [&](uint32_t h, uint32_t v) {
    return mesh.triangles[h / 3][h % 3] == v ? h : next_in_triangle(h);
  };
  std::vector<uint32_t> border_corners;
  const EdgeSides sides = find_edge_sides(mesh.triangles, mesh.vertices.size());
  for_each_edge(sides, [&](uint32_t u, uint32_t v, View<const EdgeSide> on_edge) {
    const uint32_t first = on_edge[0].half_edge;
    for (const EdgeSide& side : on_edge)
      for (const uint32_t at : {u, v}) loops.unite(corner_at(first, at), corner_at(side.half_edge, at));
    if (on_edge.size > 1) return;
    loops.unite(first, next_in_triangle(first));
    border_corners.push_back(first);
    borders.segments.push_back({u, v, v});
    borders.vertices.insert(borders.vertices.end(), {u, v});
    borders.length_world += length(mesh.vertices[v] - mesh.vertices[u]);
  });
  for (uint32_t& c : border_corners) c = loops.root(c);
  for (std::vector<uint32_t>* list : {&border_corners, &borders.vertices}) {
    std::sort(list->begin(), list->end());
    list->erase(std::unique(list->begin(), list->end()), list->end());
  }
  borders.loops = int64_t(border_corners.size());
  return borders;
}

double farthest(const TriangleMesh& from, const Borders& vertices, const TriangleMesh& to, const Borders& segments) {
  if (vertices.vertices.empty() || segments.segments.empty()) return 0;
  const TriangleGrid grid(to.vertices, segments.segments);
  std::vector<double> distance_sq(vertices.vertices.size());
  for_each_index(size_t(0), distance_sq.size(),
                 [&](size_t i) { distance_sq[i] = grid.distance_sq(from.vertices[vertices.vertices[i]]); });
  return std::sqrt(*std::max_element(distance_sq.begin(), distance_sq.end()));
}

}  // namespace

BorderMeasures measure_borders(const TriangleMesh& mesh, const TriangleMesh& reference, Context& context) {
  return run_with_threads(context, [&] {
    const Borders here = borders_of(mesh), there = borders_of(reference);
    return BorderMeasures{here.loops,
                          here.length_world,
                          there.loops,
                          there.length_world,
                          farthest(mesh, here, reference, there),
                          farthest(reference, there, mesh, here)};
  });
}

}  // namespace isoshell
