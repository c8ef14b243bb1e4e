// crossing_corners (see crossing_corners.h).
#include "measure/crossing_corners.h"

#include <algorithm>
#include <tuple>

#include "measure/crossings.h"

namespace isoshell {

std::vector<PointQ8> crossing_corners(const DualMesh& mesh, View<const uint32_t> joined) {
  const std::atomic<bool> stop{false};
  std::vector<PointQ8> corners;
  for (const auto& pair : crossing_pairs(mesh.position.view(), mesh.triangles.view(), joined, stop))
    for (const uint32_t t : pair)
      for (const uint32_t v : {mesh.triangles[t].a, mesh.triangles[t].b, mesh.triangles[t].c})
        corners.push_back(mesh.position[v]);
  const auto key = [](PointQ8 p) { return std::make_tuple(p.x, p.y, p.z); };
  std::sort(corners.begin(), corners.end(), [&](PointQ8 p, PointQ8 q) { return key(p) < key(q); });
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  return corners;
}

}  // namespace isoshell
