// What values options may have, on the command line and in a stage file that keeps them.
#pragma once

#include <limits>
#include <string>

#include "isoshell/stages.h"

namespace isoshell::tool {

struct Range {
  double low = 0, high = std::numeric_limits<double>::max();
  bool above = false;  ///< `low` itself is none of them

  bool holds(double value) const { return (above ? value > low : value >= low) && value <= high; }
  /// As in "it must be ...".
  std::string text() const;
};

constexpr Range kVertices{4, 2147483647}, kEdgeLength{0, std::numeric_limits<double>::max(), true}, kAdaptivity{0, 1},
    kGradation{1, 10, true}, kIterations{1, 1000000}, kTolerance{0, 1}, kStep{1. / kOneVoxelQ8, 1000};

/// All digits that a count or a bound has, where a stream would round to six.
std::string number_text(double value);

}  // namespace isoshell::tool
