#include "implicit/points/plane_fit.h"

#include <cmath>

#include "geometry/world_vector.h"

namespace isoshell {

WorldPoint smallest_direction(const double m[6]) {
  double a[3][3] = {{m[0], m[1], m[2]}, {m[1], m[3], m[4]}, {m[2], m[4], m[5]}};
  double v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  constexpr int kPairs[3][2] = {{0, 1}, {0, 2}, {1, 2}};
  for (int sweep = 0; sweep < 12; ++sweep)
    for (const auto& [p, q] : kPairs) {
      if (a[p][q] == 0) continue;
      const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
      const double t = (theta < 0 ? -1 : 1) / (std::abs(theta) + std::sqrt(theta * theta + 1));
      const double c = 1 / std::sqrt(t * t + 1), s = t * c;
      for (int k = 0; k < 3; ++k) {
        const double kp = a[k][p], kq = a[k][q];
        a[k][p] = c * kp - s * kq;
        a[k][q] = s * kp + c * kq;
      }
      for (int k = 0; k < 3; ++k) {
        const double pk = a[p][k], qk = a[q][k];
        a[p][k] = c * pk - s * qk;
        a[q][k] = s * pk + c * qk;
        const double vp = v[k][p], vq = v[k][q];
        v[k][p] = c * vp - s * vq;
        v[k][q] = s * vp + c * vq;
      }
    }
  int least = 0;
  for (int i = 1; i < 3; ++i)
    if (a[i][i] < a[least][least]) least = i;
  return normalised({v[0][least], v[1][least], v[2][least]});
}

PlaneFit fit_plane(const std::vector<WorldPoint>& position, const std::vector<PointTree::Near>& near) {
  WorldPoint mean{0, 0, 0};
  for (const auto& [d, i] : near) mean = {mean.x + position[i].x, mean.y + position[i].y, mean.z + position[i].z};
  mean = (1 / double(near.size())) * mean;
  double m[6] = {};
  for (const auto& [d, i] : near) {
    const double x = position[i].x - mean.x, y = position[i].y - mean.y, z = position[i].z - mean.z;
    m[0] += x * x, m[1] += x * y, m[2] += x * z, m[3] += y * y, m[4] += y * z, m[5] += z * z;
  }
  const WorldPoint n = smallest_direction(m);
  const double off = dot(n, {m[0] * n.x + m[1] * n.y + m[2] * n.z, m[1] * n.x + m[3] * n.y + m[4] * n.z,
                             m[2] * n.x + m[4] * n.y + m[5] * n.z});
  return {n, mean, off / (m[0] + m[3] + m[5])};
}

}  // namespace isoshell
