// See wall_pressures.h.
#include "geometry/wall_pressures.h"

#include <cstddef>

namespace isoshell {
namespace {

constexpr int kIterations = 30;    ///< of conjugate gradients
constexpr double kSolved = 1e-10;  ///< of the first residual's square

/// What volumes grow by when walls are offset by the differences of pressures.
std::vector<double> grown_by(const std::vector<double>& pressure, const std::vector<WallsBetween>& walls) {
  std::vector<double> out(pressure.size(), 0);
  for (const WallsBetween& w : walls) {
    const double grown = w.area * (pressure[w.region[0]] - pressure[w.region[1]]);
    out[w.region[0]] += grown;
    out[w.region[1]] -= grown;
  }
  return out;
}

double product(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (size_t r = 0; r < a.size(); ++r) sum += a[r] * b[r];
  return sum;
}

}  // namespace

uint64_t spanned_volume(const PointQ8& a, const PointQ8& b, const PointQ8& c) {
  const auto times = [](int64_t u, int64_t v) { return uint64_t(u) * uint64_t(v); };
  return (times(a.y, b.z) - times(a.z, b.y)) * uint64_t(int64_t(c.x)) +
         (times(a.z, b.x) - times(a.x, b.z)) * uint64_t(int64_t(c.y)) +
         (times(a.x, b.y) - times(a.y, b.x)) * uint64_t(int64_t(c.z));
}

/// Conjugate gradients, each equation divided by what is on its diagonal.
std::vector<double> pressures_of_regions(const std::vector<WallsBetween>& walls, std::vector<double> lacking_volume) {
  std::vector<double>& residual = lacking_volume;
  const size_t regions = residual.size();
  std::vector<double> diagonal(regions, 0), pressure(regions, 0), scaled(regions), along(regions, 0);
  for (const WallsBetween& w : walls)
    for (const uint32_t r : w.region) diagonal[r] += w.area;
  double last = 0, first = 0;
  for (int i = 0; i < kIterations; ++i) {
    for (size_t r = 0; r < regions; ++r) scaled[r] = diagonal[r] > 0 ? residual[r] / diagonal[r] : 0;
    const double size = product(residual, scaled);
    if (i == 0) first = size;
    if (size <= kSolved * first) break;
    for (size_t r = 0; r < regions; ++r) along[r] = scaled[r] + (i == 0 ? 0 : size / last) * along[r];
    last = size;
    const std::vector<double> grown = grown_by(along, walls);
    const double curvature = product(along, grown);
    if (curvature <= 0) break;
    for (size_t r = 0; r < regions; ++r) {
      pressure[r] += size / curvature * along[r];
      residual[r] -= size / curvature * grown[r];
    }
  }
  return pressure;
}

}  // namespace isoshell
