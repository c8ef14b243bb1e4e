// Vertices of a soup made one, and those left out that have no triangles.
#pragma once

#include <utility>
#include <vector>

#include "isoshell/surface_source.h"

namespace isoshell {

/// `same`: pairs of a vertex and the one whose place it is at, which stays. Triangles with a corner twice go, and
/// vertices without triangles; what stays keeps its order.
inline void make_one(TriangleSoup& soup, const std::vector<std::pair<uint32_t, uint32_t>>& same) {
  std::vector<uint32_t> number(soup.vertices.size());
  for (uint32_t v = 0; v < number.size(); ++v) number[v] = v;
  for (const auto& [vertex, stays] : same) number[vertex] = stays;
  size_t triangles = 0;
  std::vector<uint8_t> is_used(number.size(), 0);
  for (const auto& triangle : soup.triangles) {
    const uint32_t a = number[triangle[0]], b = number[triangle[1]], c = number[triangle[2]];
    if (a == b || b == c || c == a) continue;
    is_used[a] = is_used[b] = is_used[c] = 1;
    soup.triangles[triangles++] = {a, b, c};
  }
  soup.triangles.resize(triangles);
  soup.faces_in_file = int64_t(triangles);
  uint32_t vertices = 0;
  for (uint32_t v = 0; v < number.size(); ++v) {
    if (!is_used[v]) continue;
    soup.vertices[vertices] = soup.vertices[v];
    number[v] = vertices++;
  }
  soup.vertices.resize(vertices);
  for (auto& triangle : soup.triangles)
    for (uint32_t& v : triangle) v = number[v];
}

}  // namespace isoshell
