// Distances between meshes by samples. Chunks of fixed size are looked at in parallel and joined in order.
#include "isoshell/distance.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/triangle_list.h"
#include "core/watched.h"
#include "core/world_vector.h"
#include "measure/largest_distance.h"
#include "measure/triangle_grid.h"
#include "voxel/random.h"

namespace isoshell {
namespace {

constexpr int64_t kChunk = 512;
constexpr double kDegrees = 57.29577951308232;
constexpr double kOtherSideDeg = 30;  ///< normals that turn by more may be of the other side of a crease,
constexpr double kAlignedCosine = .984807753012208;  ///< if those of this side turn by 10 degrees or less
constexpr double kBeyondNearest = 1e-4;              ///< of the diagonal: how far beyond it others are looked for
constexpr double kAsNear = 1e-7;                     ///< of the diagonal: what rounding may part

void check(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) throw Error(ErrorCode::usage, "distance", "a mesh has no triangle to measure from");
  require_indices(mesh.triangles, mesh.vertices.size(), "distance");
}

/// One point in each of `count` strata of equal area, along the triangles.
class AreaSamples {
 public:
  AreaSamples(const TriangleMesh& mesh, int64_t count) : mesh_(mesh), count_(double(count)) {
    area_until_.reserve(mesh.triangles.size());
    double sum = 0;
    for (const auto& t : mesh.triangles)
      area_until_.push_back(sum += triangle_area(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]));
  }
  size_t triangle_of(int64_t number) const {
    const double at = area_until_.back() * ((double(number) + part(number, 0)) / count_);
    return size_t(std::upper_bound(area_until_.begin(), area_until_.end() - 1, at) - area_until_.begin());
  }
  WorldPoint operator[](int64_t number) const {
    const auto& t = mesh_.triangles[triangle_of(number)];
    const double root = std::sqrt(part(number, 1)), turn = part(number, 2);
    const WorldPoint a = mesh_.vertices[t[0]], b = mesh_.vertices[t[1]], c = mesh_.vertices[t[2]];
    const double u = root * (1 - turn), v = root * turn;
    return {a.x + u * (b.x - a.x) + v * (c.x - a.x), a.y + u * (b.y - a.y) + v * (c.y - a.y),
            a.z + u * (b.z - a.z) + v * (c.z - a.z)};
  }

 private:
  /// 0 to 1.
  static double part(int64_t number, uint64_t of) {
    return double(random_bits(of, uint64_t(number)) >> 11) / 9007199254740992.0;
  }

  const TriangleMesh& mesh_;
  double count_;
  std::vector<double> area_until_;
};

struct Sums {
  double sum = 0, sum_sq = 0, max_sq = 0;
  double turn_sum_deg = 0, turn_max_deg = 0;
};

WorldPoint normal_of(const TriangleMesh& mesh, size_t triangle) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  return doubled_area(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]);
}

double angle_between_deg(const WorldPoint& a, const WorldPoint& b) {
  return kDegrees * std::atan2(length(cross(a, b)), std::abs(dot(a, b)));
}

/// Turns of normals between a mesh and the one of the grid.
class NormalTurns {
 public:
  NormalTurns(const TriangleMesh& from, const TriangleMesh& to, const TriangleGrid& grid, double diagonal, bool exact)
      : from_(from), to_(to), grid_(grid), beyond_((exact ? kAsNear : kBeyondNearest) * diagonal), exact_(exact) {}

  double at(const WorldPoint& p, size_t triangle, const MeshPoint& nearest) const {
    const WorldPoint normal = normal_of(from_, triangle);
    const double size = length(normal), turn = angle_between_deg(normal, normal_of(to_, nearest.triangle));
    if (!(size > 0) || (!exact_ && turn < kOtherSideDeg)) return turn;
    const double farthest = std::sqrt(nearest.distance_sq) + beyond_;
    const MeshPoint aligned = exact_ ? grid_.most_aligned(p, 1 / size * normal, farthest)
                                     : grid_.nearest_aligned(p, 1 / size * normal, kAlignedCosine, farthest);
    return aligned.triangle == MeshPoint::kNoTriangle ? turn
                                                      : angle_between_deg(normal, normal_of(to_, aligned.triangle));
  }

 private:
  const TriangleMesh &from_, &to_;
  const TriangleGrid& grid_;
  double beyond_;
  bool exact_;
};

/// A search may be long where triangles are, so each point asks whether to go on.
template <class PointAt, class TurnAt>
Sums sum_over(int64_t count, const TriangleGrid& to, const Context& context, PointAt point_at, TurnAt turn_deg_at) {
  std::vector<Sums> parts(size_t((count + kChunk - 1) / kChunk));
  tbb::parallel_for(size_t(0), parts.size(), [&](size_t c) {
    const int64_t end = std::min(count, int64_t(c + 1) * kChunk);
    for (int64_t i = int64_t(c) * kChunk; i < end; ++i) {
      if (context.cancel.load(std::memory_order_relaxed)) return;
      const WorldPoint p = point_at(i);
      const MeshPoint nearest = to.nearest(p);
      const double turn_deg = turn_deg_at(i, p, nearest);
      parts[c].sum += std::sqrt(nearest.distance_sq);
      parts[c].sum_sq += nearest.distance_sq;
      parts[c].max_sq = std::max(parts[c].max_sq, nearest.distance_sq);
      parts[c].turn_sum_deg += turn_deg;
      parts[c].turn_max_deg = std::max(parts[c].turn_max_deg, turn_deg);
    }
  });
  check_cancel(context, "distance");
  Sums all;
  for (const Sums& part : parts) {
    all.sum += part.sum;
    all.sum_sq += part.sum_sq;
    all.max_sq = std::max(all.max_sq, part.max_sq);
    all.turn_sum_deg += part.turn_sum_deg;
    all.turn_max_deg = std::max(all.turn_max_deg, part.turn_max_deg);
  }
  return all;
}

struct OneSide {
  OneSidedDistance distance;
  NormalDeviation normals;
};
OneSide one_sided(const TriangleMesh& from, const TriangleMesh& to, double diagonal, const DistanceOptions& options,
                  const Context& context) {
  check_cancel(context, "distance");
  const TriangleGrid grid(to);
  const AreaSamples samples(from, options.samples);
  const auto vertices = int64_t(from.vertices.size());
  const int64_t stride = (vertices + kDistanceVertices - 1) / kDistanceVertices;
  const NormalTurns turns(from, to, grid, diagonal, options.exact);
  const Sums inside = sum_over(
      options.samples, grid, context, [&](int64_t i) { return samples[i]; },
      [&](int64_t i, const WorldPoint& p, const MeshPoint& near) { return turns.at(p, samples.triangle_of(i), near); });
  const Sums corners = sum_over((vertices + stride - 1) / stride, grid, context,
                                [&](int64_t i) { return from.vertices[size_t(i * stride)]; },
                                [](int64_t, const WorldPoint&, const MeshPoint&) { return 0.; });
  const double count = double(options.samples);
  OneSide side{{inside.sum / count, std::sqrt(inside.sum_sq / count),
                std::sqrt(std::max(inside.max_sq, corners.max_sq)), std::nullopt},
               {inside.turn_sum_deg / count, inside.turn_max_deg}};
  if (options.exact) {
    const LargestDistance largest = largest_distance(from, grid, diagonal, context);
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
  return run_with_threads(context, [&] {
    const double size = diagonal(reference);
    const OneSide to = one_sided(mesh, reference, size, options, context),
                  from = one_sided(reference, mesh, size, options, context);
    return MeshDistance{to.distance, from.distance, size, to.normals, from.normals};
  });
}

std::vector<double> distances(const std::vector<WorldPoint>& points, const TriangleMesh& mesh, Context& context) {
  check(mesh);
  return run_with_threads(context, [&] {
    const TriangleGrid grid(mesh);
    std::vector<double> found(points.size());
    const auto part = [&](const tbb::blocked_range<size_t>& range) {
      if (context.cancel.load(std::memory_order_relaxed)) return;
      for (size_t i = range.begin(); i < range.end(); ++i) found[i] = std::sqrt(grid.distance_sq(points[i]));
    };
    tbb::parallel_for(tbb::blocked_range<size_t>(0, points.size(), size_t(kChunk)), part);
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
