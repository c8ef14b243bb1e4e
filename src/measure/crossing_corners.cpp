// crossing_corners (see crossing_corners.h).
#include "measure/crossing_corners.h"

#include <algorithm>
#include <tuple>

#include "measure/crossings.h"

namespace isoshell {

void sort_points(std::vector<PointQ8>& places) {
  const auto key = [](PointQ8 p) { return std::make_tuple(p.x, p.y, p.z); };
  std::sort(places.begin(), places.end(), [&](PointQ8 p, PointQ8 q) { return key(p) < key(q); });
  places.erase(std::unique(places.begin(), places.end()), places.end());
}

std::vector<PointQ8> corners_of(const DualMesh& mesh, const std::vector<std::array<uint32_t, 2>>& pairs) {
  std::vector<PointQ8> corners;
  for (const auto& pair : pairs)
    for (const uint32_t t : pair)
      for (const uint32_t v : {mesh.triangles[t].a, mesh.triangles[t].b, mesh.triangles[t].c})
        corners.push_back(mesh.position[v]);
  sort_points(corners);
  return corners;
}

std::vector<PointQ8> crossing_corners(const DualMesh& mesh, View<const uint32_t> joined) {
  const std::atomic<bool> stop{false};
  return corners_of(mesh, crossing_pairs(mesh.position.view(), mesh.triangles.view(), joined, stop));
}

}  // namespace isoshell
