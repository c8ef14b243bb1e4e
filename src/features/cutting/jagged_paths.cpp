// See jagged_paths.h.
#include "features/cutting/jagged_paths.h"

#include "geometry/world_vector.h"

namespace isoshell {
namespace {

constexpr double kWindow = 4;        ///< edge lengths
constexpr double kLeastTurn = 0.35;  ///< an edge length: a circle of three edge lengths turns as much
constexpr double kMostLeft = 0.5;    ///< of all turns, once those of a window are summed

/// Along the axis, as long as the distance between the two directions.
WorldPoint turn_chord(const WorldPoint& before, const WorldPoint& after) {
  const WorldPoint axis = cross(before, after);
  const double a = length(before), b = length(after), size = length(axis);
  if (!(a > 0 && b > 0 && size > 0)) return {0, 0, 0};
  return (length((1 / b) * after - (1 / a) * before) / size) * axis;
}

bool is_jagged(const std::vector<WorldPoint>& position, double edge_length, const CurvePath& path) {
  const size_t n = path.vertex.size(), margin = path.is_loop ? 0 : 1;
  double all = 0, left = 0, window_end = kWindow * edge_length;
  WorldPoint sum{0, 0, 0};
  for (size_t i = margin; i + margin < n; ++i) {
    if (path.at[i] > window_end) {
      left += length(sum);
      sum = {0, 0, 0};
      window_end = path.at[i] + kWindow * edge_length;
    }
    const WorldPoint& here = position[path.vertex[i]];
    const WorldPoint turn =
        turn_chord(here - position[path.vertex[(i + n - 1) % n]], position[path.vertex[(i + 1) % n]] - here);
    all += length(turn);
    sum = sum + turn;
  }
  left += length(sum);
  return all > kLeastTurn * path.length / edge_length && left < kMostLeft * all;
}

}  // namespace

void find_jagged_paths(const std::vector<WorldPoint>& position, double edge_length, std::vector<CurvePath>& paths) {
  for (CurvePath& path : paths)
    path.is_jagged = (path.kind == CurveKind::border || path.kind == CurveKind::non_manifold) &&
                     is_jagged(position, edge_length, path);
}

}  // namespace isoshell
