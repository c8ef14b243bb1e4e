// See face_seams.h.
#include "pipeline/regions/face_seams.h"

#include <algorithm>

#include "geometry/half_edges.h"

namespace isoshell {

EdgeList face_seams(const FeatureMesh& walls, const TriangleSoup& soup) {
  std::vector<const Attribute*> labelled;
  for (const Attribute& a : soup.attributes)
    if (a.domain == AttributeDomain::face && !a.labels.empty()) labelled.push_back(&a);
  EdgeList found;
  if (labelled.empty()) return found;
  const EdgeSides edges = find_edge_sides(walls.triangles, walls.vertices.size());
  for_each_edge(edges, [&](uint32_t u, uint32_t v, View<const EdgeSide> sides) {
    if (sides.size != 2) return;
    const uint32_t a = walls.source_face[sides[0].half_edge / 3], b = walls.source_face[sides[1].half_edge / 3];
    if (soup.regions.labels[a] != soup.regions.labels[b]) return;
    if (std::any_of(labelled.begin(), labelled.end(),
                    [&](const Attribute* of) { return of->values[a] != of->values[b]; }))
      found.push_back({u, v});
  });
  return found;
}

}  // namespace isoshell
