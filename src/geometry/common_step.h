// Where the steps of a lattice lead, and the step that all of them are whole multiples of.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "isoshell/advanced/lattice.h"

namespace isoshell {

/// Off by so many voxels over a whole volume, points are nearer to those of the lattice than to others. Headers of
/// files are rounded by that.
constexpr double kMostOffStepVox = 1e-4;

inline double coordinate(const WorldPoint& p, size_t axis) { return axis == 0 ? p.x : axis == 1 ? p.y : p.z; }

/// The axis of the world that is nearest to a step.
inline size_t world_axis(const WorldPoint& step) {
  const double along[3] = {std::abs(step.x), std::abs(step.y), std::abs(step.z)};
  return size_t(std::max_element(along, along + 3) - along);
}

/// The shortest of the steps of a lattice, of which there are so many along each of its axes, if they are along axes of
/// the world and the others are whole multiples of it; 0 if not.
inline double common_step_world(const std::array<WorldPoint, 3>& step_world, const std::array<int64_t, 3>& count) {
  std::array<double, 3> size{};
  for (size_t i = 0; i < 3; ++i) {
    const WorldPoint& step = step_world[i];
    size[i] = std::abs(coordinate(step, world_axis(step)));
    const double aside = std::abs(step.x) + std::abs(step.y) + std::abs(step.z) - size[i];
    if (aside * double(count[i]) > kMostOffStepVox * size[i]) return 0;
  }
  const double least = *std::min_element(size.begin(), size.end());
  for (size_t i = 0; i < 3; ++i) {
    const double multiple = size[i] / least;
    if (std::abs(multiple - std::round(multiple)) * double(count[i]) > kMostOffStepVox) return 0;
  }
  return least;
}

}  // namespace isoshell
