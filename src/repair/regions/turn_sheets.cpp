// See turn_sheets.h.
#include "repair/regions/turn_sheets.h"

#include <cstddef>
#include <utility>
#include <vector>

#include "geometry/half_edges.h"

namespace isoshell::repair {
namespace {

struct Neighbour {
  uint32_t face;
  bool looks_alike;  ///< passes the edge between in the opposite direction
};

std::vector<std::vector<Neighbour>> neighbours_in_sheets(const TriangleSoup& walls) {
  std::vector<std::vector<Neighbour>> of_face(walls.triangles.size());
  for_each_edge(find_edge_sides(walls.triangles, walls.vertices.size()),
                [&](uint32_t, uint32_t, View<const EdgeSide> at_edge) {
                  if (at_edge.size != 2) return;
                  const uint32_t h = at_edge[0].half_edge, k = at_edge[1].half_edge;
                  if (!is_of_sheet(walls.regions.labels[h / 3]) || !is_of_sheet(walls.regions.labels[k / 3])) return;
                  const bool looks_alike = walls.triangles[h / 3][h % 3] != walls.triangles[k / 3][k % 3];
                  of_face[h / 3].push_back({k / 3, looks_alike});
                  of_face[k / 3].push_back({h / 3, looks_alike});
                });
  return of_face;
}

}  // namespace

void turn_sheets(TriangleSoup& walls) {
  const std::vector<std::vector<Neighbour>> neighbours = neighbours_in_sheets(walls);
  std::vector<uint8_t> is_seen(walls.triangles.size(), 0), is_turned(walls.triangles.size(), 0);
  std::vector<uint32_t> open;
  for (uint32_t first = 0; first < walls.triangles.size(); ++first) {
    if (is_seen[first] || neighbours[first].empty()) continue;
    is_seen[first] = 1;
    open = {first};
    while (!open.empty()) {
      const uint32_t face = open.back();
      open.pop_back();
      for (const Neighbour& next : neighbours[face]) {
        if (is_seen[next.face]) continue;
        is_seen[next.face] = 1;
        is_turned[next.face] = next.looks_alike ? is_turned[face] : 1 - is_turned[face];
        open.push_back(next.face);
      }
    }
  }
  for (size_t t = 0; t < is_turned.size(); ++t)
    if (is_turned[t]) std::swap(walls.triangles[t][1], walls.triangles[t][2]);
}

}  // namespace isoshell::repair
