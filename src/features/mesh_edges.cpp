#include "features/mesh_edges.h"

#include <string>

#include "core/half_edge_list.h"
#include "isoshell/buffer.h"
#include "isoshell/error.h"
#include "voxel/union_find.h"

namespace isoshell {

MeshEdges find_mesh_edges(const FeatureMesh& mesh) {
  constexpr size_t kMostTriangles = UINT32_MAX / 3;
  if (mesh.triangles.size() > kMostTriangles)
    throw Error(ErrorCode::usage, "features",
                "the input has " + std::to_string(mesh.triangles.size()) + " triangles; features can be found on " +
                    std::to_string(kMostTriangles) + " at most, simplify it");
  const std::vector<ListedHalfEdge> halves = sorted_half_edges(mesh.triangles);
  const auto rises = [&](const ListedHalfEdge& h) {
    return mesh.triangles[h.number / 3][h.number % 3] == h.smaller_end();
  };
  MeshEdges found;
  found.of_triangle.resize(mesh.triangles.size());
  for (size_t begin = 0, end = 0; begin < halves.size(); begin = end) {
    const ListedHalfEdge& first = halves[begin];
    for (; end < halves.size() && halves[end].edge == first.edge; ++end)
      found.of_triangle[halves[end].number / 3][halves[end].number % 3] = found.count();
    const ListedHalfEdge& second = halves[begin + (end - begin > 1)];
    const EdgeUse use = end - begin == 1                                    ? EdgeUse::border
                        : end - begin == 2 && rises(first) != rises(second) ? EdgeUse::inner
                                                                            : EdgeUse::non_manifold;
    found.edges.push_back({{first.smaller_end(), first.larger_end()}, {first.number / 3, second.number / 3}, use});
  }
  return found;
}

std::vector<uint32_t> components_of(const FeatureMesh& mesh, const MeshEdges& edges) {
  std::vector<uint32_t> parent(mesh.triangles.size());
  for (uint32_t t = 0; t < parent.size(); ++t) parent[t] = t;
  const View<uint32_t> sets{parent.data(), int64_t(parent.size())};
  // A triangle is joined with the first one of each of its edges, which may have many.
  for (uint32_t t = 0; t < parent.size(); ++t)
    for (const uint32_t e : edges.of_triangle[t]) join(sets, edges.edges[e].face[0], t);
  for (uint32_t t = 0; t < parent.size(); ++t) parent[t] = find_root(sets, t);
  return parent;
}

}  // namespace isoshell
