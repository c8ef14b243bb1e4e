// What values the options of a run may have: for the library, the command, and stage files that keep options.
#pragma once

#include <limits>
#include <string>

#include "isoshell/advanced/stages.h"

namespace isoshell {

struct OptionRange {
  double low = 0, high = std::numeric_limits<double>::max();
  bool above = false;  ///< `low` itself is none of them

  /// NaN lies outside of every range.
  bool holds(double value) const { return (above ? value > low : value >= low) && value <= high; }
  /// As in "vertices is 3; it must be 4 to 2147483647".
  std::string refusal(const std::string& option, double value) const;
};

namespace option_range {
constexpr OptionRange vertices{4, std::numeric_limits<int32_t>::max()},
    length{0, std::numeric_limits<double>::max(), true}, resolution{8, kMaxResolution}, band{1, kMaxBandVox},
    closing{0, kMaxClosingVox}, crease{1, 179}, adaptivity{0, 1}, gradation{1, 10, true}, iterations{1, 1000000},
    tolerance{0, 1}, step{1. / kOneVoxelQ8, 1000};
}

}  // namespace isoshell
