#include "features/mesh_edges.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <string>
#include <tuple>

#include "isoshell/buffer.h"
#include "isoshell/error.h"
#include "voxel/union_find.h"

namespace isoshell {
namespace {

/// Half-edge 3 t + i runs from corner i of triangle t to the next one.
struct HalfEdge {
  uint32_t smaller_end, larger_end;
  uint32_t number;
  bool rises;  ///< runs from the smaller to the larger end
};

std::vector<HalfEdge> sorted_half_edges(const FeatureMesh& mesh) {
  std::vector<HalfEdge> halves(3 * mesh.triangles.size());
  tbb::parallel_for(size_t(0), mesh.triangles.size(), [&](size_t t) {
    for (size_t i = 0; i < 3; ++i) {
      const uint32_t from = mesh.triangles[t][i], to = mesh.triangles[t][(i + 1) % 3];
      halves[3 * t + i] = {std::min(from, to), std::max(from, to), uint32_t(3 * t + i), from < to};
    }
  });
  tbb::parallel_sort(halves.begin(), halves.end(), [](const HalfEdge& a, const HalfEdge& b) {
    return std::tuple(a.smaller_end, a.larger_end, a.number) < std::tuple(b.smaller_end, b.larger_end, b.number);
  });
  return halves;
}

}  // namespace

MeshEdges find_mesh_edges(const FeatureMesh& mesh) {
  constexpr size_t kMostTriangles = UINT32_MAX / 3;
  if (mesh.triangles.size() > kMostTriangles)
    throw Error(ErrorCode::usage, "features",
                "the input has " + std::to_string(mesh.triangles.size()) + " triangles; features can be found on " +
                    std::to_string(kMostTriangles) + " at most, simplify it");
  const std::vector<HalfEdge> halves = sorted_half_edges(mesh);
  MeshEdges found;
  found.of_triangle.resize(mesh.triangles.size());
  for (size_t begin = 0, end = 0; begin < halves.size(); begin = end) {
    const HalfEdge& first = halves[begin];
    for (; end < halves.size() && halves[end].smaller_end == first.smaller_end &&
           halves[end].larger_end == first.larger_end;
         ++end)
      found.of_triangle[halves[end].number / 3][halves[end].number % 3] = found.count();
    const HalfEdge& second = halves[begin + (end - begin > 1)];
    const EdgeUse use = end - begin == 1                                  ? EdgeUse::border
                        : end - begin == 2 && first.rises != second.rises ? EdgeUse::inner
                                                                          : EdgeUse::non_manifold;
    found.edges.push_back({{first.smaller_end, first.larger_end}, {first.number / 3, second.number / 3}, use});
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
