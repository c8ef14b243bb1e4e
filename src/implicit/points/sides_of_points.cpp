#include "implicit/points/sides_of_points.h"

#include <algorithm>
#include <cmath>

#include "geometry/world_vector.h"

namespace isoshell {
namespace {

constexpr double kBeyond = 2.25;       // spacings: how much farther than the nearest point those of sides may be
constexpr size_t kMostSides = 4;       // that meet near a place
constexpr double kSameSide = 0.9;      // cosine
constexpr double kSameHeight = 0.75;   // spacings between points of a side along its normal
constexpr double kLeastSineSq = 0.02;  // of two planes that have a crease; of a crease and a plane that have a corner
constexpr double kOnSurface = 1e-3;    // voxels

bool is_hollow(const WorldPoint& normal_a, const WorldPoint& foot_a, const WorldPoint& normal_b,
               const WorldPoint& foot_b) {
  return dot(normal_a - normal_b, foot_b - foot_a) > 0;
}

}  // namespace

double SidesOfPoints::distance(const WorldPoint& place, const std::vector<SidePoint>& around, double nearest) {
  const double reach = nearest + kBeyond * spacing_;
  near_.clear();
  for (const SidePoint& p : around)
    if (const double d = distance_sq(place, p.at); d < reach * reach) near_.push_back({d, &p});
  std::sort(near_.begin(), near_.end(), [](const Near& a, const Near& b) {
    return a.away_sq != b.away_sq ? a.away_sq < b.away_sq : a.point < b.point;
  });
  sides_.clear();
  while (sides_.size() < kMostSides && !near_.empty()) take_side(place, reach);
  return sides_.size() == 1 ? sides_[0].distance : distance_from_planes();
}

/// The points that are on the plane of the nearest one; they are not near any more.
void SidesOfPoints::take_side(const WorldPoint& place, double reach) {
  const SidePoint& nearest = *near_[0].point;
  Side side{{0, 0, 0}, {0, 0, 0}, 0};
  double weights = 0;
  size_t kept = 0;
  for (const Near& n : near_) {
    const SidePoint& p = *n.point;
    if (dot(p.normal, nearest.normal) < kSameSide ||
        std::abs(dot(nearest.normal, p.at - nearest.at)) > kSameHeight * spacing_) {
      near_[kept++] = n;
      continue;
    }
    const double t = 1 - n.away_sq / (reach * reach), weight = t * t * t * t * p.area;
    side.normal = side.normal + weight * p.normal;
    side.foot = side.foot + weight * p.at;
    side.distance += weight * dot(p.normal, place - p.at);
    weights += weight;
  }
  near_.resize(kept);
  if (!(weights > 0)) return;
  const double size = length(side.normal);
  side.normal = (1 / size) * side.normal;
  side.foot = (1 / weights) * side.foot;
  side.distance = (side.distance / size + dot(side.normal, place - side.foot)) / 2;
  sides_.push_back(side);
}

/// Below 0 inside of all sides together.
double SidesOfPoints::value_at(const WorldPoint& from_place) const {
  double farthest = -HUGE_VAL;
  for (const Side& a : sides_) {
    double off = a.distance + dot(a.normal, from_place);
    for (const Side& b : sides_)
      if (is_hollow(a.normal, a.foot, b.normal, b.foot)) off = std::min(off, b.distance + dot(b.normal, from_place));
    farthest = std::max(farthest, off);
  }
  return farthest;
}

/// From the nearest foot on a plane, on the crease of two or at the corner of three, of those on the surface.
double SidesOfPoints::distance_from_planes() const {
  double nearest = HUGE_VAL;
  const auto offer = [&](const WorldPoint& foot) {
    if (const double far = length(foot); far < nearest && std::abs(value_at(foot)) < kOnSurface) nearest = far;
  };
  for (size_t i = 0; i < sides_.size(); ++i) {
    const Side& a = sides_[i];
    offer(-a.distance * a.normal);
    for (size_t j = i + 1; j < sides_.size(); ++j) {
      const Side& b = sides_[j];
      const WorldPoint along = cross(a.normal, b.normal);
      const double sine_sq = length_sq(along), cosine = dot(a.normal, b.normal);
      if (sine_sq < kLeastSineSq) continue;
      const WorldPoint foot = ((cosine * b.distance - a.distance) / sine_sq) * a.normal +
                              ((cosine * a.distance - b.distance) / sine_sq) * b.normal;
      offer(foot);
      for (size_t k = j + 1; k < sides_.size(); ++k) {
        const Side& c = sides_[k];
        const double slope = dot(c.normal, along);
        if (slope * slope >= kLeastSineSq * sine_sq) offer(foot - ((c.distance + dot(c.normal, foot)) / slope) * along);
      }
    }
  }
  const double value = value_at({0, 0, 0});
  return nearest == HUGE_VAL ? value : value < 0 ? -nearest : nearest;
}

}  // namespace isoshell
