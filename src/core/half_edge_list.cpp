// sorted_half_edges (see half_edge_list.h).
#include "core/half_edge_list.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

namespace isoshell {

std::vector<ListedHalfEdge> sorted_half_edges(const std::vector<std::array<uint32_t, 3>>& triangles) {
  std::vector<ListedHalfEdge> out(3 * triangles.size());
  tbb::parallel_for(size_t(0), triangles.size(), [&](size_t t) {
    for (size_t i = 0; i < 3; ++i)
      out[3 * t + i] = {edge_key(triangles[t][i], triangles[t][(i + 1) % 3]), uint32_t(3 * t + i)};
  });
  tbb::parallel_sort(out.begin(), out.end(), [](const ListedHalfEdge& a, const ListedHalfEdge& b) {
    return a.edge != b.edge ? a.edge < b.edge : a.number < b.number;
  });
  return out;
}

}  // namespace isoshell
