// What values the options of a run may have: for the library, the command, and stage files that keep options.
#pragma once

#include <limits>
#include <string>

namespace isoshell {

struct OptionRange {
  double low = 0, high = std::numeric_limits<double>::max();
  bool above = false;  ///< `low` itself is none of them

  /// NaN lies outside of every range.
  bool holds(double value) const { return (above ? value > low : value >= low) && value <= high; }
  /// As in "vertices is 3; it must be 4 to 2147483647".
  std::string refusal(const std::string& option, double value) const;
};

}  // namespace isoshell
