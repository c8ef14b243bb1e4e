// find_fans (see mesh_fans.h).
#include "features/mesh_fans.h"

#include <algorithm>
#include <string>

#include "core/parallel_ranges.h"
#include "features/edge_sides.h"
#include "isoshell/error.h"
#include "isoshell/voxel_set.h"
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

/// Numbers the sets by their roots, which are their smallest members. Returns how many there are.
uint32_t number_sets(std::vector<uint32_t>& parent) {
  const View<uint32_t> sets = view_of(parent);
  for_each_index(size_t(0), parent.size(), [&](size_t i) { PointAtRoot{sets}(int64_t(i)); });
  uint32_t count = 0;
  for (size_t i = 0; i < parent.size(); ++i) parent[i] = parent[i] == i ? count++ : parent[parent[i]];
  return count;
}

/// Which values are not 0, ascending.
std::vector<uint32_t> flagged(const std::vector<uint8_t>& flags) {
  std::vector<uint32_t> out;
  for (size_t i = 0; i < flags.size(); ++i)
    if (flags[i]) out.push_back(uint32_t(i));
  return out;
}

}  // namespace

MeshFans find_fans(const MeshTriangles& triangles, int64_t vertices, const std::vector<uint64_t>& cut_edges) {
  const EdgeSides sides = find_edge_sides(triangles, size_t(vertices));
  std::vector<uint8_t> has_cut(size_t(vertices), 0);
  for (const uint64_t edge : cut_edges) has_cut[edge >> 32] = has_cut[uint32_t(edge)] = 1;
  const auto is_cut = [&](uint32_t u, uint32_t v) {
    return has_cut[u] && has_cut[v] && std::binary_search(cut_edges.begin(), cut_edges.end(), edge_key(u, v));
  };

  MeshFans fans;
  fans.of_corner = all_alone(3 * triangles.size());
  fans.patch = all_alone(triangles.size());
  std::vector<uint8_t> is_cut_side(3 * triangles.size(), 0);
  uint32_t first_wrong = kNone, cut_found = 0;
  for_each_index(uint32_t(0), uint32_t(vertices), [&](uint32_t v) {
    for_each_edge_from(sides, v, [&](uint32_t end, View<const EdgeSide> on_edge) {
      if (is_cut(v, end)) {
        atomic_add(cut_found, 1u);
        for (const EdgeSide& s : on_edge) is_cut_side[s.half_edge] = 1;
      } else if (are_twins(triangles, on_edge)) {
        const uint32_t g = on_edge[0].half_edge, h = on_edge[1].half_edge;
        join(view_of(fans.of_corner), g, next_in_triangle(h));
        join(view_of(fans.of_corner), next_in_triangle(g), h);
        join(view_of(fans.patch), g / 3, h / 3);
      } else {
        atomic_min(first_wrong, v);
      }
    });
  });
  if (first_wrong != kNone)
    for_each_edge_from(sides, first_wrong, [&](uint32_t end, View<const EdgeSide> on_edge) {
      if (!is_cut(first_wrong, end) && !are_twins(triangles, on_edge)) refuse_edge(first_wrong, on_edge);
    });
  if (cut_found != cut_edges.size())
    throw Error(ErrorCode::usage, "features",
                std::to_string(cut_edges.size() - cut_found) + " of " + std::to_string(cut_edges.size()) +
                    " edges of curves are no edges of the mesh; find the curves on this very mesh");
  fans.cut = flagged(is_cut_side);
  fans.patch_count = number_sets(fans.patch);
  fans.vertex.resize(number_sets(fans.of_corner));
  for_each_index(size_t(0), fans.of_corner.size(),
                 [&](size_t c) { fans.vertex[fans.of_corner[c]] = start_of(triangles, uint32_t(c)); });
  return fans;
}

}  // namespace isoshell
