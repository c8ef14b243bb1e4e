// The step that those of a lattice along its axes are whole multiples of.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace isoshell {

/// Off by so many voxels over a whole volume, points are nearer to those of the lattice than to others. Headers of
/// files are rounded by that.
constexpr double kMostOffStepVox = 1e-4;

/// The shortest of these steps, of which there are so many along each axis, if the others are whole multiples of it; 0
/// if not.
inline double common_step_world(const std::array<double, 3>& step_world, const std::array<int64_t, 3>& count) {
  const double least = *std::min_element(step_world.begin(), step_world.end());
  for (size_t i = 0; i < 3; ++i) {
    const double multiple = step_world[i] / least;
    if (std::abs(multiple - std::round(multiple)) * double(count[i]) > kMostOffStepVox) return 0;
  }
  return least;
}

}  // namespace isoshell
