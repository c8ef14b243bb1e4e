#include "geometry/weld.h"

#include <tbb/parallel_sort.h>

#include <tuple>

#include "geometry/world_vector.h"

namespace isoshell {
namespace {

/// Its position lies beside its number for the sort.
struct UsedVertex {
  WorldPoint at;
  uint32_t number;

  bool operator<(const UsedVertex& o) const {
    return std::tie(at.x, at.y, at.z, number) < std::tie(o.at.x, o.at.y, o.at.z, o.number);
  }
};

}  // namespace

WeldedVertices weld_vertices(const std::vector<WorldPoint>& vertices,
                             const std::vector<std::array<uint32_t, 3>>& triangles) {
  std::vector<uint8_t> is_used(vertices.size(), 0);
  for (const auto& t : triangles)
    for (const uint32_t v : t) is_used[v] = 1;
  std::vector<UsedVertex> used;
  used.reserve(is_used.size());
  for (uint32_t v = 0; v < is_used.size(); ++v)
    if (is_used[v]) used.push_back({vertices[v], v});
  tbb::parallel_sort(used.begin(), used.end());
  WeldedVertices welded;
  welded.position.reserve(used.size());
  welded.place.assign(vertices.size(), 0);
  for (const auto& [p, v] : used) {
    if (welded.position.empty() || !(welded.position.back() == p)) welded.position.push_back(p);
    welded.place[v] = uint32_t(welded.position.size() - 1);
  }
  return welded;
}

}  // namespace isoshell
