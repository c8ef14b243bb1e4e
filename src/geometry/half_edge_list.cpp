// sorted_half_edges (see half_edge_list.h): gathered at their smaller end, sorted there.
#include "geometry/half_edge_list.h"

#include <algorithm>

#include "core/parallel_ranges.h"

namespace isoshell {
namespace {

constexpr int64_t kVerticesAtATime = 4096;

}  // namespace

std::vector<ListedHalfEdge> sorted_half_edges(const std::vector<std::array<uint32_t, 3>>& triangles) {
  uint32_t largest = 0;
  for (const auto& t : triangles) largest = std::max({largest, t[0], t[1], t[2]});
  std::vector<uint32_t> first(size_t(largest) + 2);  // of those at each vertex
  for (const auto& [a, b, c] : triangles)
    for (const uint32_t smaller_end : {std::min(a, b), std::min(b, c), std::min(c, a)}) ++first[smaller_end];
  uint32_t end = 0;
  for (uint32_t& f : first) f = end += f;
  std::vector<ListedHalfEdge> out(3 * triangles.size());
  for (size_t t = triangles.size(); t-- > 0;) {
    const auto& [a, b, c] = triangles[t];
    const auto put = [&](uint32_t from, uint32_t to, size_t i) {
      out[--first[std::min(from, to)]] = {edge_key(from, to), uint32_t(3 * t + i)};
    };
    put(c, a, 2);
    put(b, c, 1);
    put(a, b, 0);
  }
  for_ranges(int64_t(first.size()) - 1, kVerticesAtATime, [&](int64_t from, int64_t to) {
    for (size_t v = size_t(from); v < size_t(to); ++v)
      std::sort(out.begin() + first[v], out.begin() + first[v + 1],
                [](const ListedHalfEdge& a, const ListedHalfEdge& b) {
                  return a.edge != b.edge ? a.edge < b.edge : a.number < b.number;
                });
  });
  return out;
}

}  // namespace isoshell
