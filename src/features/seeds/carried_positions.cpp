// See carried_positions.h.
#include "features/seeds/carried_positions.h"

#include <algorithm>
#include <limits>

#include "geometry/point_cells.h"
#include "geometry/segment.h"

namespace isoshell {
namespace {

constexpr double kReach = 0.1;       ///< edge lengths from a path
constexpr double kCellWidth = 0.75;  ///< of the mean edge length: about as much as an edge of a path and its reach

double mean_length_on_paths(const FineMesh& mesh) {
  double sum = 0, count = 0;
  for (const CurvePath& path : mesh.paths)
    for (const uint32_t v : path.vertex) sum += mesh.edge_length[v], ++count;
  return count > 0 ? sum / count : 1;
}

}  // namespace

std::vector<PositionOnPath> positions_on_paths(const FineMesh& mesh, const std::vector<WorldPoint>& points) {
  std::vector<PositionOnPath> nearest(points.size());
  if (points.empty()) return nearest;
  const PointCells cells(points, kCellWidth * mean_length_on_paths(mesh));
  std::vector<double> least_sq(points.size(), std::numeric_limits<double>::infinity());
  for (size_t p = 0; p < mesh.paths.size(); ++p) {
    const CurvePath& path = mesh.paths[p];
    for (size_t edge = 0; edge < path.edge_count(); ++edge) {
      const uint32_t u = path.vertex[edge], v = path.edge_end(edge);
      const WorldPoint &a = mesh.position[u], &b = mesh.position[v];
      const double reach = kReach * std::max(mesh.edge_length[u], mesh.edge_length[v]);
      cells.for_each_in(widened(box_of(a, b), reach), [&](size_t i) {
        const double part = nearest_part(points[i], a, b);
        const double d = distance_sq(points[i], a + part * (b - a));
        const double near = kReach * ((1 - part) * mesh.edge_length[u] + part * mesh.edge_length[v]);
        if (d >= near * near || d >= least_sq[i]) return;
        least_sq[i] = d;
        nearest[i] = {p, part < 1 ? PathPoint{edge, part} : PathPoint{edge + 1, 0}};
      });
    }
  }
  for (PositionOnPath& place : nearest) {
    if (place.path == PositionOnPath::kNoPath) continue;
    const CurvePath& path = mesh.paths[place.path];
    if (path.is_loop && place.at.edge == path.edge_count()) place.at.edge = 0;
  }
  return nearest;
}

}  // namespace isoshell
