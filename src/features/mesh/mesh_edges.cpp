#include "features/mesh/mesh_edges.h"

#include <string>

#include "core/parallel_ranges.h"
#include "geometry/half_edges.h"
#include "isoshell/error.h"
#include "voxel/union_find.h"

namespace isoshell {

MeshEdges find_mesh_edges(const FeatureMesh& mesh) {
  constexpr size_t kMostTriangles = UINT32_MAX / 3;
  if (mesh.triangles.size() > kMostTriangles)
    throw NoRoom("features", "the input has " + std::to_string(mesh.triangles.size()) +
                                 " triangles; features can be found on " + std::to_string(kMostTriangles) +
                                 " at most, simplify it");
  const EdgeSides sides = find_edge_sides(mesh.triangles, mesh.vertices.size());
  Buffer<int64_t> first(sides.first.size());
  first[sides.count()] = 0;
  for_each_index(int64_t(0), sides.count(), [&](int64_t v) {
    int64_t count = 0;
    for_each_edge_from(sides, v, [&](uint32_t, View<const EdgeSide>) { ++count; });
    first[v] = count;
  });
  offsets_from_counts(first.view());
  MeshEdges found{Buffer<FeatureEdge>(first[sides.count()]),
                  Buffer<std::array<uint32_t, 3>>(int64_t(mesh.triangles.size()))};
  for_each_index(int64_t(0), sides.count(), [&](int64_t v) {
    auto e = uint32_t(first[v]);
    for_each_edge_from(sides, v, [&](uint32_t end, View<const EdgeSide> on_edge) {
      for (const EdgeSide& s : on_edge) found.of_triangle[s.half_edge / 3][s.half_edge % 3] = e;
      const uint32_t g = on_edge[0].half_edge, h = on_edge[on_edge.size > 1 ? 1 : 0].half_edge;
      const bool are_opposite = mesh.triangles[g / 3][g % 3] != mesh.triangles[h / 3][h % 3];
      const EdgeUse use = on_edge.size == 1                   ? EdgeUse::border
                          : on_edge.size == 2 && are_opposite ? EdgeUse::inner
                                                              : EdgeUse::non_manifold;
      found.edges[e++] = {{uint32_t(v), end}, {g / 3, h / 3}, use};
    });
  });
  return found;
}

std::vector<uint32_t> components_of(const FeatureMesh& mesh, const MeshEdges& edges) {
  std::vector<uint32_t> parent(mesh.triangles.size());
  const View<uint32_t> sets{parent.data(), int64_t(parent.size())};
  const auto for_all = [&](auto use) { for_each_index(uint32_t(0), uint32_t(parent.size()), use); };
  for_all(StartAlone{sets});
  // A triangle is joined with the first one of each of its edges, which may have many.
  for_all([&](uint32_t t) {
    for (const uint32_t e : edges.of_triangle[t])
      if (const uint32_t first = edges.edges[e].face[0]; first != t) join(sets, first, t);
  });
  for_all(PointAtRoot{sets});
  return parent;
}

}  // namespace isoshell
