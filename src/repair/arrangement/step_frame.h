// The lattice of an arrangement in the world.
#pragma once

#include <cmath>

#include "geometry/box.h"
#include "geometry/world_vector.h"
#include "repair/arrangement/lattice_faces.h"

namespace isoshell::repair {

/// From the world to steps and back. Around the faces is room for what moves them.
class StepFrame {
 public:
  explicit StepFrame(const WorldBox& box) : least_(box.min) {
    const double longest = longest_side(box);
    a_step_ = longest > 0 ? longest / (kSteps - 2 * kMarginSteps) : 1;
  }
  StepPoint from(const WorldPoint& p) const {
    const WorldPoint s = (1 / a_step_) * (p - least_);
    const auto rounded = [](double x) { return int64_t(std::floor(x + kMarginSteps + .5)); };
    return {rounded(s.x), rounded(s.y), rounded(s.z)};
  }
  double steps(double length_world) const { return length_world / a_step_; }
  WorldPoint to_world(StepPoint s) const {
    return least_ +
           a_step_ * WorldPoint{double(s.x) - kMarginSteps, double(s.y) - kMarginSteps, double(s.z) - kMarginSteps};
  }

 private:
  static constexpr double kSteps = double(int64_t(1) << 40), kMarginSteps = 1 << 24;
  WorldPoint least_;
  double a_step_;
};

}  // namespace isoshell::repair
