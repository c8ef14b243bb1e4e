#include "implicit/points/flat_normals.h"

#include <algorithm>
#include <cmath>

#include "core/parallel_ranges.h"
#include "geometry/world_vector.h"
#include "implicit/points/plane_fit.h"

namespace isoshell {
namespace {

constexpr size_t kFewNeighbours = 16, kManyNeighbours = 40;  // more of them are flatter where points are off
constexpr size_t kFewest = 4;                                // points of a plane
constexpr double kOtherSide = -0.5;   // cosine: points that face away more are of the other side of a wall
constexpr size_t kTried = 20000;      // points, at most, that tell a sharp body
constexpr double kLeastBent = 0.004;  // part of the scatter of neighbours that is off their plane; a ball's have .003
constexpr double kBentToUsual = 4;    // the same, times the median: points are off their surface
constexpr double kVeryBent = 5;       // times what bent ones have at least; creases of 45 degrees have more
constexpr int64_t kMostBent = 2;      // neighbourhoods for each bent one, at least
constexpr int64_t kVeryShare = 3;     // bent ones for each very bent one, at most; smooth bodies have seven
constexpr double kFlatter = 0.25;     // of a neighbour's plane that is taken over, to the point's own
constexpr double kPasses = 0.35;      // spacings between a point and a plane that it is on
constexpr int kRounds = 3;

class Neighbourhoods {
 public:
  Neighbourhoods(const OrientedPoints& points, const PointTree& tree, size_t degree)
      : points_(points), tree_(tree), degree_(std::min(degree, points.position.size() - 1)) {}

  /// Whether points are those of a sharp body. Sets what is bent.
  bool is_sharp() {
    const size_t count = points_.position.size(), stride = (count + kTried - 1) / kTried;
    std::vector<double> off((count + stride - 1) / stride);
    for_each_index(size_t(0), off.size(), [&](size_t i) { off[i] = plane_of(i * stride, nullptr).off; });
    std::vector<double> sorted = off;
    const auto middle = sorted.begin() + std::ptrdiff_t(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    bent_ = std::max(kLeastBent, kBentToUsual * *middle);
    int64_t bent = 0, very_bent = 0;
    for (const double o : off) bent += o > bent_, very_bent += o > kVeryBent * bent_;
    return bent > 0 && kMostBent * bent <= int64_t(off.size()) && kVeryShare * very_bent >= bent;
  }

  std::vector<WorldPoint> normals() const {
    const size_t count = points_.position.size();
    std::vector<PlaneFit> plane(count);
    std::vector<uint32_t> neighbour(count * degree_);
    for_each_index(size_t(0), count, [&](size_t i) { plane[i] = plane_of(i, &neighbour[i * degree_]); });
    for (int round = 0; round < kRounds; ++round) {
      const std::vector<PlaneFit> before = plane;
      for_each_index(size_t(0), count, [&](size_t i) {
        if (before[i].off > bent_) plane[i] = flat_plane(i, before, &neighbour[i * degree_]);
      });
    }
    std::vector<WorldPoint> normal(count);
    for (size_t i = 0; i < count; ++i) normal[i] = plane[i].normal;
    return normal;
  }

 private:
  /// The plane of a point and its neighbours, outward, and these, if they are asked for.
  PlaneFit plane_of(size_t i, uint32_t* neighbour) const {
    std::vector<PointTree::Near> near;
    tree_.nearest(points_.position[i], degree_ + 1, near);
    for (size_t k = 0, put = 0; neighbour && put < degree_; ++k)
      if (near[k].second != i || k == degree_) neighbour[put++] = near[k].second;
    const auto faces_away = [&](const PointTree::Near& n) {
      return dot(points_.normal[n.second], points_.normal[i]) <= kOtherSide;
    };
    near.erase(std::remove_if(near.begin(), near.end(), faces_away), near.end());
    if (near.size() < kFewest) return {points_.normal[i], points_.position[i], 0};
    PlaneFit plane = fit_plane(points_.position, near);
    if (dot(plane.normal, points_.normal[i]) < 0) plane.normal = -1 * plane.normal;
    return plane;
  }

  /// Of the much flatter planes of neighbours the one that passes nearest, else its own.
  PlaneFit flat_plane(size_t i, const std::vector<PlaneFit>& plane, const uint32_t* neighbour) const {
    PlaneFit found = plane[i];
    double nearest = kPasses * points_.spacing;
    for (size_t k = 0; k < degree_; ++k) {
      const PlaneFit& other = plane[neighbour[k]];
      if (!(other.off < kFlatter * plane[i].off)) continue;
      const double away = std::abs(dot(other.normal, points_.position[i] - other.mean));
      if (away >= nearest) continue;
      nearest = away;
      found = other;
    }
    return found;
  }

  const OrientedPoints& points_;
  const PointTree& tree_;
  const size_t degree_;
  double bent_ = 0;
};

}  // namespace

std::vector<WorldPoint> find_flat_normals(const OrientedPoints& points, const PointTree& tree) {
  for (const size_t degree : {kFewNeighbours, kManyNeighbours})
    if (Neighbourhoods around(points, tree, degree); around.is_sharp()) return around.normals();
  return {};
}

}  // namespace isoshell
