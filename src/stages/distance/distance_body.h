// sum_distances (see core/distance_sums.h), written once over an executor.
#pragma once

#include <cmath>

#include "geometry/distance_sums.h"
#include "geometry/turn.h"
#include "voxel/random.h"

namespace isoshell {
namespace distance_steps {

constexpr double kOtherSideDeg = 30;  ///< normals that turn by more may be of the other side of a crease,
constexpr double kAlignedCosine = .984807753012208;  ///< if those of this side turn by 10 degrees or less
constexpr double kBeyondNearest = 1e-4;              ///< of the diagonal: how far beyond it others are looked for
constexpr double kAsNear = 1e-7;                     ///< of the diagonal: what rounding may part

/// A mesh, and the sum of the areas of its triangles up to each of them.
struct SampledMesh {
  View<const WorldPoint> vertices;
  View<const std::array<uint32_t, 3>> triangles;
  View<const double> area_until;

  ISOSHELL_HD int64_t triangle_at(double area) const {
    int64_t first = 0, last = triangles.size - 1;
    while (first < last) {
      const int64_t middle = (first + last) / 2;
      if (area < area_until[middle])
        last = middle;
      else
        first = middle + 1;
    }
    return first;
  }
  ISOSHELL_HD WorldPoint normal_of(int64_t triangle) const {
    const auto& t = triangles[triangle];
    return doubled_area(vertices[t[0]], vertices[t[1]], vertices[t[2]]);
  }
};

struct Found {
  double distance_sq, turn_deg;
};

/// Sums of a chunk of places: area samples first, vertices behind them.
struct SumPlaces {
  static constexpr int64_t kChunk = 512;
  SampledMesh from;
  TriangleGridView to;
  DistancePlaces places;
  View<DistanceSums> sums;

  ISOSHELL_HD int64_t count() const {
    return places.samples + (from.vertices.size + places.vertex_stride - 1) / places.vertex_stride;
  }
  ISOSHELL_HD int64_t end(int64_t chunk) const {
    return (chunk + 1) * kChunk < count() ? (chunk + 1) * kChunk : count();
  }

  ISOSHELL_HD Found at(int64_t place) const {
    if (place >= places.samples)
      return {to.nearest(from.vertices[(place - places.samples) * places.vertex_stride]).distance_sq, 0};
    const double stratum = double(place) + part_of(place, 0);
    const int64_t triangle =
        from.triangle_at(from.area_until[from.triangles.size - 1] * (stratum / double(places.samples)));
    const WorldPoint p = point_in(from.triangles[triangle], place);
    const MeshPoint nearest = to.nearest(p);
    return {nearest.distance_sq, turn_deg(p, from.normal_of(triangle), nearest)};
  }
  ISOSHELL_HD void add(int64_t place, const Found& found, DistanceSums& s) const {
    s.max_sq = s.max_sq < found.distance_sq ? found.distance_sq : s.max_sq;
    if (place >= places.samples) return;
    s.sum += std::sqrt(found.distance_sq);
    s.sum_sq += found.distance_sq;
    s.turn_sum_deg += found.turn_deg;
    s.turn_max_deg = s.turn_max_deg < found.turn_deg ? found.turn_deg : s.turn_max_deg;
  }
  ISOSHELL_HD void operator()(int64_t chunk) const {
    DistanceSums s;
    for (int64_t place = chunk * kChunk; place < end(chunk); ++place) add(place, at(place), s);
    sums[chunk] = s;
  }

 private:
  /// 0 to 1.
  ISOSHELL_HD static double part_of(int64_t place, uint64_t of) {
    return double(random_bits(of, uint64_t(place)) >> 11) / 9007199254740992.0;
  }
  ISOSHELL_HD WorldPoint point_in(const std::array<uint32_t, 3>& t, int64_t place) const {
    const double root = std::sqrt(part_of(place, 1)), turn = part_of(place, 2);
    const WorldPoint a = from.vertices[t[0]];
    return a + root * (1 - turn) * (from.vertices[t[1]] - a) + root * turn * (from.vertices[t[2]] - a);
  }
  ISOSHELL_HD double turn_deg(const WorldPoint& p, const WorldPoint& normal, const MeshPoint& nearest) const {
    const double size = length(normal), turn = angle_between_deg(normal, to.normal_of(nearest.triangle));
    if (!(size > 0) || (!places.best_aligned && turn < kOtherSideDeg)) return turn;
    const double beyond = (places.best_aligned ? kAsNear : kBeyondNearest) * places.diagonal;
    const double farthest = std::sqrt(nearest.distance_sq) + beyond;
    const MeshPoint aligned = places.best_aligned ? to.most_aligned(p, 1 / size * normal, farthest)
                                                  : to.nearest_aligned(p, 1 / size * normal, kAlignedCosine, farthest);
    return aligned.triangle == MeshPoint::kNoTriangle ? turn
                                                      : angle_between_deg(normal, to.normal_of(aligned.triangle));
  }
};

}  // namespace distance_steps

template <class Exec>
DistanceSums sum_distances_body(Exec& exec, const distance_steps::SampledMesh& from, const TriangleGridView& to,
                                const DistancePlaces& places) {
  using distance_steps::SumPlaces;
  SumPlaces step{from, to, places, {}};
  const int64_t chunks = (step.count() + SumPlaces::kChunk - 1) / SumPlaces::kChunk;
  Buffer<DistanceSums> sums = exec.template make<DistanceSums>(chunks);
  step.sums = sums.view();
  exec.for_each("sum distances", chunks, step);
  DistanceSums all;
  for (const DistanceSums& part : sums.to_host()) {
    all.sum += part.sum;
    all.sum_sq += part.sum_sq;
    all.max_sq = part.max_sq > all.max_sq ? part.max_sq : all.max_sq;
    all.turn_sum_deg += part.turn_sum_deg;
    all.turn_max_deg = part.turn_max_deg > all.turn_max_deg ? part.turn_max_deg : all.turn_max_deg;
  }
  return all;
}

}  // namespace isoshell
