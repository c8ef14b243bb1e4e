// Lines on a surface that the result is to have as edges, as a user gives them.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "isoshell/advanced/lattice.h"

namespace isoshell {

/// Straight segments between points near the surface, world units. What meets in a point is joined there.
struct Polylines {
  std::vector<WorldPoint> points;
  std::vector<std::array<uint32_t, 2>> segments;  ///< two different points each
  std::string source;                             ///< the file that they come from; empty: memory
  std::vector<int64_t> lines = {};                ///< per segment its line in a text file, from 1; empty: not known

  /// The segment as messages call it: "marks.obj, line 7", or "segment 3" of what has no lines.
  std::string name_of(size_t segment) const;
};

}  // namespace isoshell
