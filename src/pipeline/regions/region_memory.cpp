// See region_memory.h. The coefficients are bytes an element, set by the peaks that whole runs showed: of 0.3 to 2
// million vertices of walls, with results of 10,000 to 40,000.
#include "pipeline/regions/region_memory.h"

#include <algorithm>
#include <cmath>

#include "core/parallel_ranges.h"
#include "core/wall_memory.h"
#include "features/mesh/refine_mesh.h"
#include "geometry/world_vector.h"
#include "isoshell/error.h"
#include "isoshell/readable.h"
#include "pipeline/grid/memory_estimate.h"
#include "pipeline/grid/sizing.h"
#include "pipeline/regions/region_lengths.h"

namespace isoshell {
namespace {

constexpr double kBytesPerWallVertex = 60;        ///< the walls as they came in, welded
constexpr double kBytesPerThinnedVertex = 420;    ///< where most vertices go before walls are cut: meanwhile
constexpr double kBytesOfSmallWalls = 112 << 20;  ///< which stay as they are then
constexpr int64_t kPointsWhenThinned = 16;        ///< fine points for one of the result, then
constexpr double kBytesPerSeed = 500;
constexpr double kFixedBytes = 16 << 20;
constexpr int64_t kTrianglesOfTask = 4096;

/// Twice the vertices that one triangle gets beside its corners, those on edges shared with the neighbours: whole
/// numbers, whose sum no order changes.
int64_t twice_points_in(const WorldPoint& a, const WorldPoint& b, const WorldPoint& c, double longest) {
  constexpr double kMost = 1e12;
  double on_edges = 0, fewest = kMost, most = 0;
  for (const double sq : {distance_sq(a, b), distance_sq(b, c), distance_sq(c, a)}) {
    const double parts = std::clamp(std::ceil(std::sqrt(sq) / longest), 1.0, kMost);
    on_edges += parts - 1;
    fewest = std::min(fewest, parts);
    most = std::max(most, parts);
  }
  return int64_t(std::min(kMost, on_edges + (fewest - 1) * std::max(0.0, most - 2)));
}

}  // namespace

RunEstimate estimate_walls(const Plan& plan, const TriangleSoup& walls, const std::vector<double>& of_face_world,
                           const LatticeFrame& frame) {
  RunEstimate e;
  e.resolution = frame.resolution;
  e.voxel_size_world = frame.voxel_size;
  const LengthsOnWalls lengths(walls, plan, of_face_world);
  e.vertices = std::llround(lengths.vertices());
  e.vertex_bytes = int64_t(kBytesPerSeed * double(e.vertices));
  const double parts = walls.regions.are_of_voxels ? kPartsOfRoughEdge : kPartsOfEdge;
  const int64_t twice_inside =
      sum_over_ranges(int64_t(walls.triangles.size()), kTrianglesOfTask, [&](int64_t begin, int64_t end) {
        int64_t sum = 0;
        for (auto t = size_t(begin); t < size_t(end); ++t) {
          const auto& [a, b, c] = walls.triangles[t];
          const double longest = lengths.on_triangle_world(t) / parts;
          sum += twice_points_in(walls.vertices[a], walls.vertices[b], walls.vertices[c], longest);
        }
        return sum;
      });
  const auto vertices = int64_t(walls.vertices.size());
  e.sheet_vertices = vertices + twice_inside / 2;
  const double bytes_of_walls = kBytesPerWallVertex * double(vertices);
  double bytes = bytes_of_walls + kBytesPerFinePoint * double(e.sheet_vertices) + kBytesPerSeed * double(e.vertices);
  if (!wants_lengths(plan.options) && are_thinned_out(walls, e.vertices)) {
    e.sheet_vertices = kPointsWhenThinned * e.vertices;
    bytes = std::max(kBytesOfSmallWalls + kBytesPerThinnedVertex * double(vertices),
                     bytes_of_walls + kBytesPerFinePoint * double(e.sheet_vertices));
  }
  e.bytes = int64_t(kFixedBytes + bytes);
  if (walls.regions.are_of_voxels)
    e.bytes = std::max(e.bytes, bytes_to_make_walls(int64_t(walls.triangles.size()), vertices));
  return e;
}

void require_memory_for_walls(const RunEstimate& estimate, const Context& context) {
  if (context.memory_limit_bytes <= 0 || estimate.bytes <= context.memory_limit_bytes) return;
  throw Error(ErrorCode::out_of_memory, "memory",
              "the walls between regions, cut for " + counted(estimate.vertices, "vertex", "vertices") +
                  ", need about " + readable_bytes(estimate.bytes) + ", more than the limit of " +
                  readable_bytes(context.memory_limit_bytes) +
                  "; raise --max-memory, ask for fewer vertices, or make the volume coarser");
}

}  // namespace isoshell
