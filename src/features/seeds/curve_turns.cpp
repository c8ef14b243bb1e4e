// limit_by_curve_turns (see length_limits.h).
#include <algorithm>
#include <cmath>

#include "features/seeds/length_limits.h"
#include "geometry/world_vector.h"

namespace isoshell {
namespace {

/// Twice the tangent of half the turn from one direction to the other, along the axis.
WorldPoint turn_tangent(const WorldPoint& before, const WorldPoint& after) {
  constexpr double kLeastCosine = 1e-3;  // above: -1
  const double scale = std::sqrt(length_sq(before) * length_sq(after));
  if (!(scale > 0)) return {};
  return 2 / (scale * std::max(kLeastCosine, 1 + dot(before, after) / scale)) * cross(before, after);
}

/// Sums of turns up to every vertex of a path, twice around a loop.
struct TurnSums {
  std::vector<double> at;
  std::vector<WorldPoint> sum;  ///< one more than `at`: up to, and without, the vertex
};

TurnSums sum_turns(const std::vector<WorldPoint>& position, const CurvePath& path) {
  const size_t n = path.vertex.size(), rounds = path.is_loop ? 3 : 1;
  TurnSums sums;
  sums.sum.push_back({});
  for (size_t i = 0; i < n * rounds; ++i) {
    const size_t k = i % n;
    WorldPoint turn{};
    if (path.is_loop || (k > 0 && k + 1 < n)) {
      const WorldPoint& here = position[path.vertex[k]];
      turn = turn_tangent(here - position[path.vertex[(k + n - 1) % n]], position[path.vertex[(k + 1) % n]] - here);
    }
    sums.at.push_back(path.at[k] + double(i / n) * path.length);
    sums.sum.push_back(sums.sum.back() + turn);
  }
  return sums;
}

}  // namespace

void limit_by_curve_turns(const std::vector<WorldPoint>& position, const std::vector<CurvePath>& paths, double e,
                          std::vector<double>& limit) {
  for (const CurvePath& path : paths) {
    if (path.is_jagged) continue;
    const TurnSums sums = sum_turns(position, path);
    const double width = std::min(e, path.length);
    const double shift = path.is_loop ? path.length : 0;  // the middle one of three rounds
    for (size_t i = 0; i < path.vertex.size(); ++i) {
      double begin = path.at[i] + shift - width / 2;
      if (!path.is_loop) begin = std::clamp(begin, 0.0, path.length - width);
      const auto first = std::lower_bound(sums.at.begin(), sums.at.end(), begin) - sums.at.begin();
      const auto last = std::lower_bound(sums.at.begin(), sums.at.end(), begin + width) - sums.at.begin();
      const double turn = length(sums.sum[size_t(last)] - sums.sum[size_t(first)]);
      double& l = limit[path.vertex[i]];
      if (turn * e > kEdgeOfRadius * width) l = std::min(l, kEdgeOfRadius * width / turn);
    }
  }
}

}  // namespace isoshell
