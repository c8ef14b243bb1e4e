// find_fans (see mesh_fans.h).
#include "features/mesh/mesh_fans.h"

#include <algorithm>
#include <string>

#include "core/parallel_ranges.h"
#include "isoshell/advanced/voxel_set.h"
#include "isoshell/error.h"
#include "voxel/union_find.h"

namespace isoshell {
namespace {

uint32_t start_of(const MeshTriangles& triangles, uint32_t h) { return triangles[h / 3][h % 3]; }

/// Whether an edge has two triangles, which pass it in opposite directions.
bool are_twins(const MeshTriangles& triangles, View<const EdgeSide> sides) {
  return sides.size == 2 && start_of(triangles, sides[0].half_edge) != start_of(triangles, sides[1].half_edge);
}

[[noreturn]] void refuse_edge(uint32_t vertex, View<const EdgeSide> sides) {
  throw Error(ErrorCode::usage, "features",
              "the edge between vertices " + std::to_string(vertex) + " and " + std::to_string(sides[0].larger_end) +
                  (sides.size == 2 ? " is passed by both of its triangles the same way"
                                   : " has " + std::to_string(sides.size) + " triangles") +
                  " and is on no curve; find the curves on this very mesh, with every border and non-manifold edge");
}

std::vector<uint32_t> all_alone(size_t count) {
  std::vector<uint32_t> parent(count);
  for_each_index(size_t(0), count, [&](size_t i) { parent[i] = uint32_t(i); });
  return parent;
}
View<uint32_t> view_of(std::vector<uint32_t>& values) { return {values.data(), int64_t(values.size())}; }

void point_at_roots(std::vector<uint32_t>& parent) {
  const View<uint32_t> sets = view_of(parent);
  for_each_index(size_t(0), parent.size(), [&](size_t i) { PointAtRoot{sets}(int64_t(i)); });
}

/// Numbers the sets by their roots, which are their smallest members and what all point at. Returns how many there are.
uint32_t number_sets(std::vector<uint32_t>& parent) {
  uint32_t count = 0;
  for (size_t i = 0; i < parent.size(); ++i) parent[i] = parent[i] == i ? count++ : parent[parent[i]];
  return count;
}

/// Throws where some of the half-edges are of edges that are not to be cut, or others are missing.
void require_cut_along(const MeshTriangles& triangles, int64_t vertices, const std::vector<uint32_t>& half_edges,
                       const std::vector<uint64_t>& cut_edges) {
  uint64_t first_wrong = UINT64_MAX;
  std::vector<uint8_t> is_found(cut_edges.size(), 0);
  for (const uint32_t h : half_edges) {
    const uint64_t edge = edge_key(start_of(triangles, h), start_of(triangles, next_in_triangle(h)));
    const auto at = std::lower_bound(cut_edges.begin(), cut_edges.end(), edge);
    if (at != cut_edges.end() && *at == edge)
      is_found[size_t(at - cut_edges.begin())] = 1;
    else
      first_wrong = std::min(first_wrong, edge);
  }
  if (first_wrong != UINT64_MAX) {
    const EdgeSides sides = find_edge_sides(triangles, size_t(vertices));
    for_each_edge_from(sides, int64_t(first_wrong >> 32), [&](uint32_t end, View<const EdgeSide> on_edge) {
      if (end == uint32_t(first_wrong)) refuse_edge(uint32_t(first_wrong >> 32), on_edge);
    });
  }
  if (const auto missing = std::count(is_found.begin(), is_found.end(), 0); missing > 0)
    throw Error(ErrorCode::usage, "features",
                std::to_string(missing) + " of " + std::to_string(cut_edges.size()) +
                    " edges of curves are no edges of the mesh; find the curves on this very mesh");
}

}  // namespace

MeshTwins find_twins(const MeshTriangles& triangles, const EdgeSides& sides, const std::vector<uint64_t>& cut_edges) {
  std::vector<uint8_t> has_cut(size_t(sides.count()), 0);
  for (const uint64_t edge : cut_edges) has_cut[edge >> 32] = has_cut[uint32_t(edge)] = 1;
  MeshTwins twins{std::vector<uint32_t>(3 * triangles.size(), kNone), all_alone(triangles.size())};
  for_each_index(uint32_t(0), uint32_t(sides.count()), [&](uint32_t v) {
    for_each_edge_from(sides, v, [&](uint32_t end, View<const EdgeSide> on_edge) {
      if (!are_twins(triangles, on_edge)) return;
      if (has_cut[v] && has_cut[end] && std::binary_search(cut_edges.begin(), cut_edges.end(), edge_key(v, end)))
        return;
      const uint32_t g = on_edge[0].half_edge, h = on_edge[1].half_edge;
      twins.of[g] = h;
      twins.of[h] = g;
      join(view_of(twins.part), g / 3, h / 3);
    });
  });
  point_at_roots(twins.part);
  return twins;
}

MeshFans find_fans(const MeshTriangles& triangles, int64_t vertices, const std::vector<uint64_t>& cut_edges) {
  return find_fans(triangles, vertices, cut_edges,
                   find_twins(triangles, find_edge_sides(triangles, size_t(vertices)), cut_edges));
}

MeshFans find_fans(const MeshTriangles& triangles, int64_t vertices, const std::vector<uint64_t>& cut_edges,
                   MeshTwins twins) {
  MeshFans fans;
  for (uint32_t h = 0; h < twins.of.size(); ++h)
    if (twins.of[h] == kNone) fans.cut.push_back(h);
  require_cut_along(triangles, vertices, fans.cut, cut_edges);
  fans.patch = std::move(twins.part);
  fans.patch_count = number_sets(fans.patch);
  fans.of_corner = all_alone(twins.of.size());
  for_each_index(uint32_t(0), uint32_t(twins.of.size()), [&](uint32_t g) {
    // Those at its other end are joined from its twin.
    if (const uint32_t h = twins.of[g]; h != kNone) join(view_of(fans.of_corner), g, next_in_triangle(h));
  });
  point_at_roots(fans.of_corner);
  fans.vertex.resize(number_sets(fans.of_corner));
  for_each_index(size_t(0), fans.of_corner.size(),
                 [&](size_t c) { fans.vertex[fans.of_corner[c]] = start_of(triangles, uint32_t(c)); });
  return fans;
}

}  // namespace isoshell
