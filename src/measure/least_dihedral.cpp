// find_least_dihedral (see isoshell/quality.h).
#include <cmath>

#include "geometry/dihedral.h"
#include "geometry/half_edges.h"
#include "geometry/triangle_list.h"
#include "isoshell/quality.h"

namespace isoshell {
namespace {

struct Sharpest {
  double cosine = -1;
  uint32_t from = 0, to = 0;

  const Sharpest& sharper(const Sharpest& o) const { return o.cosine > cosine ? o : *this; }
};

WorldPoint apex(const TriangleMesh& mesh, const EdgeSide& side) {
  return mesh.vertices[mesh.triangles[side.half_edge / 3][(side.half_edge + 2) % 3]];
}

Sharpest at_edge(const TriangleMesh& mesh, uint32_t u, uint32_t v, View<const EdgeSide> on_edge) {
  Sharpest found{-1, u, v};
  for (int64_t i = 0; i < on_edge.size; ++i)
    for (int64_t j = 0; j < i; ++j)
      found.cosine = std::max(found.cosine, cosine_at_edge(mesh.vertices[u], mesh.vertices[v], apex(mesh, on_edge[i]),
                                                           apex(mesh, on_edge[j])));
  return found;
}

}  // namespace

LeastDihedral find_least_dihedral(const TriangleMesh& mesh) {
  require_indices(mesh.triangles, mesh.vertices.size(), "quality");
  const EdgeSides sides = find_edge_sides(mesh.triangles, mesh.vertices.size());
  const auto of_vertex = [&](size_t u) {
    Sharpest found;
    for_each_edge_from(sides, int64_t(u), [&](uint32_t v, View<const EdgeSide> on_edge) {
      found = found.sharper(at_edge(mesh, uint32_t(u), v, on_edge));
    });
    return found;
  };
  const auto sharper = [](const Sharpest& a, const Sharpest& b) { return a.sharper(b); };
  const Sharpest found = joined_over(mesh.vertices.size(), Sharpest(), of_vertex, sharper);
  if (found.cosine <= -1) return {};
  constexpr double kDegrees = 180 / 3.14159265358979323846;
  return {kDegrees * std::acos(found.cosine), .5 * (mesh.vertices[found.from] + mesh.vertices[found.to])};
}

}  // namespace isoshell
