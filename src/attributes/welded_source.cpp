#include "attributes/welded_source.h"

#include "core/attribute_values.h"
#include "core/parallel_ranges.h"
#include "features/mesh/weld_for_features.h"
#include "geometry/world_vector.h"

namespace isoshell {
namespace {

/// The value that a triangle has at one of its vertices.
const double* value_at(const WeldedSource& source, const Attribute& a, uint32_t triangle, uint32_t vertex) {
  if (a.domain == AttributeDomain::face) return value_of(a, source.mesh.source_face[triangle]);
  const auto& corners = source.mesh.triangles[triangle];
  return value_of(a, source.corner(triangle, corners[0] == vertex ? 0 : corners[1] == vertex ? 1 : 2));
}

}  // namespace

WeldedSource weld_source(const TriangleSoup& soup) {
  WeldedSource source{weld_for_features(soup), {}, {}};
  source.edges = find_mesh_edges(source.mesh);
  source.first_corner.resize(source.mesh.triangles.size());
  for_each_index(size_t(0), source.first_corner.size(), [&](size_t t) {
    const auto& face = soup.triangles[source.mesh.source_face[t]];
    const WorldPoint& first = source.mesh.vertices[source.mesh.triangles[t][0]];
    while (!(soup.vertices[face[source.first_corner[t]]] == first)) ++source.first_corner[t];
  });
  return source;
}

std::vector<Jump> find_jumps(const WeldedSource& source, const Attribute& attribute) {
  std::vector<Jump> jumps(source.edges.count(), Jump::none);
  for_each_index(size_t(0), jumps.size(), [&](size_t e) {
    const FeatureEdge& edge = source.edges.edges[e];
    if (edge.use != EdgeUse::inner) return;
    int differing = 0;
    for (const uint32_t v : edge.end)
      differing += !is_same(value_at(source, attribute, edge.face[0], v), value_at(source, attribute, edge.face[1], v),
                            attribute.components);
    jumps[e] = Jump(differing);
  });
  return jumps;
}

}  // namespace isoshell
