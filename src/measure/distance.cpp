// Distances between meshes by samples.
#include "isoshell/distance.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/parallel_ranges.h"
#include "core/watched.h"
#include "geometry/box.h"
#include "geometry/distance_sums.h"
#include "geometry/triangle_list.h"
#include "geometry/world_vector.h"
#include "measure/largest_distance.h"

namespace isoshell {
namespace {

constexpr size_t kChunk = 512;

void check(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) throw Error(ErrorCode::usage, "distance", "a mesh has no triangle to measure from");
  require_indices(mesh.triangles, mesh.vertices.size(), "distance");
}

struct OneSide {
  OneSidedDistance distance;
  NormalDeviation normals;
};
OneSide one_sided(const TriangleMesh& from, const TriangleMesh& to, double diagonal, const DistanceOptions& options,
                  Context& context) {
  check_cancel(context, "distance");
  const TriangleGrid grid(to);
  const auto vertices = int64_t(from.vertices.size());
  const DistancePlaces places{options.samples, (vertices + kDistanceVertices - 1) / kDistanceVertices, diagonal,
                              options.exact};
  const DistanceSums sums = sum_distances(from, grid, places, context);
  const double count = double(options.samples);
  OneSide side{{sums.sum / count, std::sqrt(sums.sum_sq / count), std::sqrt(sums.max_sq), std::nullopt},
               {sums.turn_sum_deg / count, sums.turn_max_deg}};
  if (options.exact) {
    const LargestDistance largest =
        run_with_threads(context, [&] { return largest_distance(from, grid, diagonal, context); });
    side.distance.max = std::max(side.distance.max, largest.found);
    side.distance.at_most = std::max(side.distance.max, largest.at_most);
  }
  return side;
}

}  // namespace

MeshDistance measure_distance(const TriangleMesh& mesh, const TriangleMesh& reference, Context& context,
                              const DistanceOptions& options) {
  check(mesh);
  check(reference);
  if (options.samples < 1) throw Error(ErrorCode::usage, "distance", "there must be a sample of each mesh");
  const WorldBox box = box_of(reference.vertices, reference.triangles);
  const double size = length(box.max - box.min);
  const OneSide to = one_sided(mesh, reference, size, options, context),
                from = one_sided(reference, mesh, size, options, context);
  return {to.distance, from.distance, size, to.normals, from.normals};
}

MeshDistance measure_distance(const TriangleMesh& mesh, const std::vector<WorldPoint>& reference, Context& context) {
  if (reference.empty()) throw Error(ErrorCode::usage, "distance", "there is no point to measure from");
  MeshDistance found;
  found.is_one_way = true;
  OneSidedDistance& from = found.from_reference;
  double sum = 0, sum_sq = 0;
  for (const double d : distances(reference, mesh, context)) {
    sum += d;
    sum_sq += d * d;
    from.max = std::max(from.max, d);
  }
  from.mean = sum / double(reference.size());
  from.rms = std::sqrt(sum_sq / double(reference.size()));
  from.at_most = from.max;
  const WorldBox box = box_of(reference);
  found.diagonal = length(box.max - box.min);
  return found;
}

std::vector<double> distances(const std::vector<WorldPoint>& points, const TriangleMesh& mesh, Context& context) {
  check(mesh);
  return run_with_threads(context, [&] {
    const TriangleGrid grid(mesh);
    std::vector<double> found(points.size());
    for_ranges(int64_t(points.size()), int64_t(kChunk), [&](int64_t begin, int64_t end) {
      if (context.cancel.load(std::memory_order_relaxed)) return;
      for (size_t i = size_t(begin); i < size_t(end); ++i) found[i] = std::sqrt(grid.distance_sq(points[i]));
    });
    check_cancel(context, "distance");
    return found;
  });
}

TriangleMesh to_world(const LatticeSurface& surface) {
  TriangleMesh mesh;
  mesh.vertices.reserve(size_t(surface.points.size()));
  for (const PointQ8& p : surface.points) mesh.vertices.push_back(surface.frame.to_world(p));
  mesh.triangles = list_of(surface.triangles.view());
  return mesh;
}

}  // namespace isoshell
