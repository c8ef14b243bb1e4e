// Distances between meshes by samples.
#include "isoshell/distance.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/parallel_ranges.h"
#include "core/watched.h"
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

double diagonal(const TriangleMesh& mesh) {
  WorldPoint lo = mesh.vertices[mesh.triangles[0][0]], hi = lo;
  for (const auto& t : mesh.triangles)
    for (const uint32_t v : t) {
      const WorldPoint p = mesh.vertices[v];
      lo = {std::min(lo.x, p.x), std::min(lo.y, p.y), std::min(lo.z, p.z)};
      hi = {std::max(hi.x, p.x), std::max(hi.y, p.y), std::max(hi.z, p.z)};
    }
  const WorldPoint d = hi - lo;
  return std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
}

}  // namespace

MeshDistance measure_distance(const TriangleMesh& mesh, const TriangleMesh& reference, Context& context,
                              const DistanceOptions& options) {
  check(mesh);
  check(reference);
  if (options.samples < 1) throw Error(ErrorCode::usage, "distance", "there must be a sample of each mesh");
  const double size = diagonal(reference);
  const OneSide to = one_sided(mesh, reference, size, options, context),
                from = one_sided(reference, mesh, size, options, context);
  return {to.distance, from.distance, size, to.normals, from.normals};
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
  mesh.triangles.reserve(size_t(surface.triangles.size()));
  for (const TriangleIndices& t : surface.triangles) mesh.triangles.push_back({t.a, t.b, t.c});
  return mesh;
}

}  // namespace isoshell
