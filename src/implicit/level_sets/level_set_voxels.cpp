// See level_set_voxels.h.
#include "implicit/level_sets/level_set_voxels.h"

#include <algorithm>
#include <array>
#include <utility>

#include "geometry/world_vector.h"
#include "isoshell/error.h"
#include "isoshell/readable.h"

namespace isoshell {
namespace {

constexpr double kWidestGap = 1;  ///< voxels; between level sets that face each other, so that none is left between
constexpr double kLeastFacing = -0.6;  ///< cosine between slopes: wedges between two that are wider stay open
constexpr double kTouching = 1. / 64;  ///< voxels: of those that touch a voxel between them may be just outside of both
constexpr double kLeastSlope = 0.1;    ///< of a difference of distances; where both are as far, nothing has a normal
constexpr int32_t kMargin = 2;         ///< voxels around all that is inside: with gaps, and without walls at the sides
constexpr double kOfOneValue = 1e-4;   ///< voxels: what values beyond a band differ by, as they are rounded

constexpr double kDepth = 2;  ///< voxels: how far behind a closed gap values are looked at

std::array<int32_t, 3> axes_of(Voxel v) { return {v.x, v.y, v.z}; }

/// Linear between voxels.
double sampled(const DistanceBlocks& set, const WorldPoint& p) {
  const Voxel low{int32_t(std::floor(p.x)), int32_t(std::floor(p.y)), int32_t(std::floor(p.z))};
  const double x = p.x - low.x, y = p.y - low.y, z = p.z - low.z;
  double sum = 0;
  for (int32_t i = 0; i < 8; ++i) {
    const int32_t a = i & 1, b = i >> 1 & 1, c = i >> 2;
    sum += (a ? x : 1 - x) * (b ? y : 1 - y) * (c ? z : 1 - z) * double(set.at({low.x + a, low.y + b, low.z + c}));
  }
  return sum;
}

}  // namespace

LevelSetVoxels::LevelSetVoxels(const std::vector<DistanceBlocks>& sets, const std::vector<std::string>& names,
                               const std::string& file)
    : sets_(sets) {
  for (const DistanceBlocks& set : sets_)
    if (!set.inside_corners().empty()) narrowest_band_ = std::min(narrowest_band_, set.band_vox());
  find_box(names, file);
  list_sets();
}

void LevelSetVoxels::find_box(const std::vector<std::string>& names, const std::string& file) {
  int32_t low[3], size[3];
  for (size_t axis = 0; axis < 3; ++axis) {
    int64_t least = INT64_MAX, most = INT64_MIN;
    size_t lowest = 0, highest = 0;
    for (size_t s = 0; s < sets_.size(); ++s) {
      const std::vector<Voxel>& corners = sets_[s].inside_corners();
      if (corners.empty()) continue;
      const int32_t from = axes_of(corners.front())[axis], to = axes_of(corners.back())[axis];
      if (from < least) least = from, lowest = s;
      if (to > most) most = to, highest = s;
    }
    if (least > most) return;
    const int64_t voxels = most - least + 1 + 2 * kMargin;
    if (voxels > 2 * kMaxResolution)
      throw Error(ErrorCode::out_of_memory, "read",
                  file + ": the box around its level sets has " + with_commas(voxels) + " voxels along " + "xyz"[axis] +
                      ", from \"" + names[lowest] + "\" to \"" + names[highest] + "\"; at most " +
                      with_commas(2 * kMaxResolution) +
                      " are taken: name level sets that are nearer to each other, or resample them coarser");
    low[axis] = int32_t(least - kMargin);
    size[axis] = int32_t(voxels);
  }
  low_ = {low[0], low[1], low[2]};
  size_ = {size[0], size[1], size[2]};
}

void LevelSetVoxels::list_sets() {
  for (uint32_t s = 0; s < sets_.size(); ++s)
    sets_[s].for_each_block([&](Voxel block) { sets_in_[block].push_back(s); });
}

const std::vector<uint32_t>& LevelSetVoxels::sets_around(Voxel v) const {
  static const std::vector<uint32_t> none;
  const auto found = sets_in_.find({v.x >> 3, v.y >> 3, v.z >> 3});
  return found == sets_in_.end() ? none : found->second;
}

Standing LevelSetVoxels::standing_at(Voxel v, const std::vector<uint32_t>& sets_around) const {
  Standing found;
  for (const uint32_t s : sets_around) {
    const double of_set = value(s, v);
    if (of_set < found.first_value) {
      found.second = std::exchange(found.first, s);
      found.second_value = std::exchange(found.first_value, of_set);
    } else if (of_set < found.second_value) {
      found.second = s;
      found.second_value = of_set;
    }
  }
  found.united = united_at(v, found);
  return found;
}

bool LevelSetVoxels::is_undecided(const Standing& standing) const {
  return standing.second_value <= kOfOneValue - narrowest_band_;
}

/// Outside of all: how far from the ball between the nearest points of the two nearest, where their gap is closed.
double LevelSetVoxels::united_at(Voxel v, const Standing& standing) const {
  const double own = standing.first_value;
  if (own < 0 || !(standing.second_value < kWidestGap)) return own;
  const WorldPoint first = normalised(sets_[standing.first].slope(v)),
                   second = normalised(sets_[standing.second].slope(v));
  const WorldPoint to_first = -own * first, to_second = -standing.second_value * second;
  const double gap = length(to_second - to_first);
  if (gap > kWidestGap || dot(first, second) > kLeastFacing) return own;
  return std::min(own, length(.5 * (to_first + to_second)) - gap / 2 - kTouching);
}

double LevelSetVoxels::depth_at(Voxel v, const Standing& standing) const {
  const double first = standing.first_value, second = standing.second_value;
  if (!(first > -kDepth && second < kDepth + kWidestGap && std::abs(first + second) <= kWidestGap))
    return standing.united;
  const DistanceBlocks &one = sets_[standing.first], &other = sets_[standing.second];
  const WorldPoint up = normalised(one.slope(v)), down = normalised(other.slope(v));
  if (dot(up, down) > kLeastFacing) return standing.united;
  const WorldPoint across = normalised(up - down), at{double(v.x), double(v.y), double(v.z)};
  const double within =
      std::max(sampled(one, at - (first + kDepth) * across), sampled(other, at + (second + kDepth) * across));
  return std::min(standing.united, within);
}

/// The background's is 0, but as much more as the closing of a gap lowers the least value.
double LevelSetVoxels::difference(Voxel v, int32_t label, int32_t other) const {
  const auto value_of = [&](int32_t of) {
    if (of > 0) return value(size_t(of) - 1, v);
    const Standing standing = standing_at(v);
    return standing.united < standing.first_value ? standing.first_value - standing.united : 0.;
  };
  return value_of(label) - value_of(other);
}

WallCrossing LevelSetVoxels::crossing(Voxel near, Voxel far, int32_t near_label, int32_t far_label) const {
  WallCrossing found;
  const double from = difference(near, near_label, far_label), to = difference(far, near_label, far_label);
  if (!(from <= 0 && to >= 0 && to > from)) return found;
  const double at = from / (from - to);
  found.at = float(at);
  const auto slope = [&](Voxel v) { return slope_of(v, near_label) - slope_of(v, far_label); };
  const WorldPoint normal = (1 - at) * slope(near) + at * slope(far);
  const auto is_closed = [&](Voxel v) {
    const Standing standing = standing_at(v);
    return standing.united < standing.first_value;
  };
  if (length(normal) < kLeastSlope) return found;
  if ((near_label == 0 || far_label == 0) && (is_closed(near) || is_closed(far))) return found;
  const WorldPoint unit = normalised(normal);
  found.normal = {float(unit.x), float(unit.y), float(unit.z)};
  return found;
}

}  // namespace isoshell
