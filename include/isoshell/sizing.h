// Edge lengths to aim at, as a user gives them.
#pragma once

#include <string>
#include <vector>

#include "isoshell/surface_source.h"

namespace isoshell {

/// A function of the place. Result: a function of each point alone.
class SizingField {
 public:
  virtual ~SizingField() = default;
  /// Lengths in world units at the points, more than 0 and finite, or 0 where the field says nothing.
  virtual std::vector<double> lengths_at(const std::vector<WorldPoint>& points) const = 0;
  /// What to read it from again, for a run that resumes; empty when that is not known.
  virtual std::string source() const { return {}; }
};

/// Edge lengths that a run aimed at, world units, and how well the mesh has them.
struct SizingReport {
  bool varies = false;
  double least_world = 0, largest_world = 0;
  double edge_error_mean = 0;  ///< of |length / target - 1| over the edges; targets are those of the count of vertices
};

}  // namespace isoshell
