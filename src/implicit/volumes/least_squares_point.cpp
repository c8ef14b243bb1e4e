#include "implicit/volumes/least_squares_point.h"

#include <algorithm>
#include <cmath>

#include "geometry/world_vector.h"

namespace isoshell {
namespace {

constexpr int kMostSweeps = 16;

/// A symmetric matrix, and the turn that makes it diagonal: by Jacobi's rotations, which take square roots only.
struct Eigen {
  double m[3][3] = {};
  double axes[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};  // columns

  void solve() {
    for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
      if (m[0][1] == 0 && m[0][2] == 0 && m[1][2] == 0) return;
      rotate(0, 1);
      rotate(0, 2);
      rotate(1, 2);
    }
  }
  void rotate(int p, int q) {
    if (m[p][q] == 0) return;
    const double theta = (m[q][q] - m[p][p]) / (2 * m[p][q]);
    const double t = (theta < 0 ? -1 : 1) / (std::abs(theta) + std::sqrt(theta * theta + 1));
    const double c = 1 / std::sqrt(t * t + 1), s = t * c;
    for (auto& row : m) turn(row[p], row[q], c, s);
    for (int i = 0; i < 3; ++i) turn(m[p][i], m[q][i], c, s);
    for (auto& row : axes) turn(row[p], row[q], c, s);
    m[p][q] = m[q][p] = 0;
  }
  static void turn(double& a, double& b, double c, double s) {
    const double was = a;
    a = c * was - s * b;
    b = s * was + c * b;
  }
};

}  // namespace

LeastSquaresPoint least_squares_point(const std::vector<WeightedPlane>& planes, const WorldPoint& from,
                                      double least_eigenvalue) {
  Eigen eigen;
  WorldPoint pull{0, 0, 0};
  for (const WeightedPlane& plane : planes) {
    const double n[3] = {plane.normal.x, plane.normal.y, plane.normal.z};
    const double off = plane.height - dot(plane.normal, from);
    pull = pull + (plane.weight * off) * plane.normal;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) eigen.m[i][j] += plane.weight * n[i] * n[j];
  }
  eigen.solve();
  const double largest = std::max({eigen.m[0][0], eigen.m[1][1], eigen.m[2][2]});
  LeastSquaresPoint found{from, {0, 0, 0}};
  int undecided = 0;
  for (int k = 0; k < 3; ++k) {
    const WorldPoint axis{eigen.axes[0][k], eigen.axes[1][k], eigen.axes[2][k]};
    if (eigen.m[k][k] > least_eigenvalue * largest) {
      found.at = found.at + (dot(axis, pull) / eigen.m[k][k]) * axis;
    } else {
      ++undecided;
      found.along = axis;
    }
  }
  if (undecided != 1) found.along = {0, 0, 0};
  return found;
}

}  // namespace isoshell
