// find_fans (see mesh_fans.h).
#include "features/mesh_fans.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <string>

#include "isoshell/error.h"
#include "voxel/union_find.h"

namespace isoshell {
namespace {

uint32_t start_of(const MeshTriangles& triangles, uint32_t h) { return triangles[h / 3][h % 3]; }

[[noreturn]] void refuse_edge(uint64_t edge, const std::string& what) {
  throw Error(ErrorCode::usage, "features",
              "the edge between vertices " + std::to_string(edge >> 32) + " and " + std::to_string(uint32_t(edge)) +
                  what + "; find the curves on this very mesh, with every border and non-manifold edge");
}

std::vector<uint32_t> all_alone(size_t count) {
  std::vector<uint32_t> parent(count);
  tbb::parallel_for(size_t(0), count, [&](size_t i) { parent[i] = uint32_t(i); });
  return parent;
}
View<uint32_t> view_of(std::vector<uint32_t>& values) { return {values.data(), int64_t(values.size())}; }

/// Numbers the sets by their roots, which are their smallest members. Returns how many there are.
uint32_t number_sets(std::vector<uint32_t>& parent) {
  const View<uint32_t> sets = view_of(parent);
  tbb::parallel_for(size_t(0), parent.size(), [&](size_t i) { PointAtRoot{sets}(int64_t(i)); });
  uint32_t count = 0;
  for (size_t i = 0; i < parent.size(); ++i) parent[i] = parent[i] == i ? count++ : parent[parent[i]];
  return count;
}

}  // namespace

MeshFans find_fans(const MeshTriangles& triangles, int64_t vertices, const std::vector<uint64_t>& cut_edges) {
  const std::vector<ListedHalfEdge> edges = sorted_half_edges(triangles);
  std::vector<char> has_cut(size_t(vertices), 0);
  for (const uint64_t edge : cut_edges) has_cut[edge >> 32] = has_cut[uint32_t(edge)] = 1;
  const auto is_cut = [&](uint64_t edge) {
    return has_cut[edge >> 32] && has_cut[uint32_t(edge)] &&
           std::binary_search(cut_edges.begin(), cut_edges.end(), edge);
  };

  MeshFans fans;
  fans.of_corner = all_alone(edges.size());
  fans.patch = all_alone(triangles.size());
  size_t cut_found = 0;
  std::vector<size_t> pairs;
  for (size_t i = 0, end; i < edges.size(); i = end) {
    for (end = i; end < edges.size() && edges[end].edge == edges[i].edge;) ++end;
    if (is_cut(edges[i].edge)) {
      ++cut_found;
      for (size_t j = i; j < end; ++j) fans.cut.push_back(edges[j].number);
    } else if (end - i != 2) {
      refuse_edge(edges[i].edge, " has " + std::to_string(end - i) + " triangles and is on no curve");
    } else if (start_of(triangles, edges[i].number) == start_of(triangles, edges[i + 1].number)) {
      refuse_edge(edges[i].edge, " is passed by both of its triangles the same way and is on no curve");
    } else {
      pairs.push_back(i);
    }
  }
  if (cut_found != cut_edges.size())
    throw Error(ErrorCode::usage, "features",
                std::to_string(cut_edges.size() - cut_found) + " of " + std::to_string(cut_edges.size()) +
                    " edges of curves are no edges of the mesh; find the curves on this very mesh");
  std::sort(fans.cut.begin(), fans.cut.end());

  tbb::parallel_for(size_t(0), pairs.size(), [&](size_t i) {
    const uint32_t g = edges[pairs[i]].number, h = edges[pairs[i] + 1].number;
    join(view_of(fans.of_corner), g, next_in_triangle(h));
    join(view_of(fans.of_corner), next_in_triangle(g), h);
    join(view_of(fans.patch), g / 3, h / 3);
  });
  fans.patch_count = number_sets(fans.patch);
  fans.vertex.resize(number_sets(fans.of_corner));
  for (size_t c = 0; c < fans.of_corner.size(); ++c) fans.vertex[fans.of_corner[c]] = start_of(triangles, uint32_t(c));
  return fans;
}

}  // namespace isoshell
