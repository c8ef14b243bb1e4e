// place_walls (see place_walls.h).
#include "implicit/labels/place_walls.h"

#include <algorithm>
#include <cmath>

#include "geometry/world_vector.h"
#include "implicit/labels/elastic_net.h"
#include "implicit/labels/part_crossing.h"
#include "implicit/labels/read_progress.h"
#include "implicit/labels/wall_links.h"
#include "implicit/volumes/least_squares_point.h"

namespace isoshell {
namespace {

constexpr double kFirstShare = 0.25;       // of the way: as in fair_walls()
constexpr double kSameSide = 0.9;          // cosine: planes of one side count as one, however many crossings it has
constexpr double kLeastTurn = 0.8;         // cosine: planes that turn by more are of several sides
constexpr double kLeastEigenvalue = 0.05;  // of the largest: below it sides are one that is curved
constexpr double kInward = 0.1;            // of the way to the mean of crossings
constexpr double kReach = 0.49;            // of a voxel: vertices stay apart
constexpr double kEnd = 1. / 64;           // of the way from centre to centre: so do crossings from their ends

class WallPlacer {
 public:
  WallPlacer(const LabelWalls& walls, const LabelVolume& volume, const Buckets<uint32_t>& faces_at)
      : walls_(walls), volume_(volume), faces_at_(faces_at) {}

  PointQ8 place(size_t vertex) const {
    std::vector<int64_t> crossed;
    for (const uint32_t f : faces_at_.in(int64_t(vertex))) crossed.push_back(walls_.crossed[f]);
    std::sort(crossed.begin(), crossed.end());
    crossed.erase(std::unique(crossed.begin(), crossed.end()), crossed.end());
    WorldPoint sum{0, 0, 0};
    std::vector<WeightedPlane> planes;
    for (const int64_t face : crossed) {
      const WallCrossing crossing = crossing_of(volume_, face);
      const WorldPoint at = place_of(crossing), normal{crossing.normal[0], crossing.normal[1], crossing.normal[2]};
      sum = sum + at;
      if (length_sq(normal) > 0) planes.push_back({normal, dot(normal, at), 1});
    }
    const WorldPoint mean = (1. / double(crossed.size())) * sum;
    const Voxel& quarters = walls_.rest_quarters[vertex];
    return rounded(meeting_of(planes, mean), {quarters.x / 4., quarters.y / 4., quarters.z / 4.});
  }

 private:
  /// In voxels from the corner of the first one.
  WorldPoint place_of(const WallCrossing& crossing) const {
    const int64_t nx = volume_.size_vox[0], ny = volume_.size_vox[1], far = crossing.face / 3;
    double at[3] = {double(far % nx) + .5, double(far / nx % ny) + .5, double(far / nx / ny) + .5};
    at[crossing.face % 3] -= 1 - std::clamp(double(crossing.at), kEnd, 1 - kEnd);
    return {at[0], at[1], at[2]};
  }
  /// Of one side that is curved planes meet outside of it and the mean of their points lies inside. Some of the way
  /// between is where triangles enclose the volume of a ball.
  static WorldPoint meeting_of(std::vector<WeightedPlane>& planes, const WorldPoint& mean) {
    double most_turned = 1;
    for (WeightedPlane& p : planes) {
      int same = 0;
      for (const WeightedPlane& q : planes) {
        const double cosine = std::abs(dot(p.normal, q.normal));
        most_turned = std::min(most_turned, cosine);
        same += cosine > kSameSide;
      }
      p.weight = 1. / same;
    }
    if (planes.empty()) return mean;
    const WorldPoint meeting = least_squares_point(planes, mean, kLeastEigenvalue).at;
    return most_turned > kLeastTurn ? meeting + kInward * (mean - meeting) : meeting;
  }
  static PointQ8 rounded(const WorldPoint& p, const WorldPoint& rest) {
    const auto near = [](double at, double to) {
      return int32_t(std::floor(std::clamp(at, to - kReach, to + kReach) * kOneVoxelQ8 + 0.5));
    };
    return {near(p.x, rest.x), near(p.y, rest.y), near(p.z, rest.z)};
  }

  const LabelWalls& walls_;
  const LabelVolume& volume_;
  const Buckets<uint32_t>& faces_at_;
};

}  // namespace

WallCrossing crossing_of(const LabelVolume& volume, int64_t face) {
  const auto found = std::lower_bound(volume.crossings.begin(), volume.crossings.end(), face,
                                      [](const WallCrossing& c, int64_t f) { return c.face < f; });
  if (found != volume.crossings.end() && found->face == face) return *found;
  WallCrossing middle;
  middle.face = face;
  return middle;
}

std::vector<PointQ8> place_walls(const LabelWalls& walls, const LabelVolume& volume, const Context& context) {
  const Buckets<uint32_t> faces_at = faces_at_vertices(walls);
  ElasticNet net(walls, faces_at, volume.smoothing_vox);
  net.step(kFirstShare);
  const std::vector<PointQ8> parted = net.rounded();
  const WallPlacer placer(walls, volume, faces_at);
  std::vector<PointQ8> position(walls.rest_quarters.size());
  for_each_index(size_t(0), position.size(), [&](size_t v) { position[v] = placer.place(v); });
  tell_read(context, kFaired);
  part_crossing(walls, faces_at, parted, position, context);
  return position;
}

}  // namespace isoshell
