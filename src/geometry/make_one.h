// Vertices of a soup made one, and those left out that have no triangles.
#pragma once

#include <utility>
#include <vector>

#include "isoshell/surface_source.h"

namespace isoshell {

/// Drops vertices without triangles; the others keep their order.
inline void drop_unused_vertices(TriangleSoup& soup) {
  std::vector<uint32_t> number(soup.vertices.size(), 0);
  for (const auto& triangle : soup.triangles)
    for (const uint32_t v : triangle) number[v] = 1;
  uint32_t kept = 0;
  for (size_t v = 0; v < number.size(); ++v) {
    if (number[v] == 0) continue;
    soup.vertices[kept] = soup.vertices[v];
    number[v] = kept++;
  }
  soup.vertices.resize(kept);
  for (auto& triangle : soup.triangles)
    for (uint32_t& v : triangle) v = number[v];
}

/// `same`: pairs of a vertex and the one whose place it is at, which stays. Triangles with a corner twice go, and
/// vertices without triangles; what stays keeps its order.
inline void make_one(TriangleSoup& soup, const std::vector<std::pair<uint32_t, uint32_t>>& same) {
  std::vector<uint32_t> number(soup.vertices.size());
  for (uint32_t v = 0; v < number.size(); ++v) number[v] = v;
  for (const auto& [vertex, stays] : same) number[vertex] = stays;
  size_t triangles = 0;
  for (const auto& triangle : soup.triangles) {
    const uint32_t a = number[triangle[0]], b = number[triangle[1]], c = number[triangle[2]];
    if (a != b && b != c && c != a) soup.triangles[triangles++] = {a, b, c};
  }
  soup.triangles.resize(triangles);
  soup.faces_in_file = int64_t(triangles);
  drop_unused_vertices(soup);
}

}  // namespace isoshell
