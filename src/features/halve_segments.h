// Shorter segments of curves where edges of the result would cross.
#pragma once

#include <optional>
#include <vector>

#include "features/cut_surface.h"

namespace isoshell {

/// The surface with another seed in the middle of every segment of a curve that is within about `reach_q8` of points.
/// None where no curve is near a point, or segments there are too short to be cut. In host memory.
std::optional<CutSurface> halve_segments(const CutSurface& cut, const std::vector<PointQ8>& points, double reach_q8);

}  // namespace isoshell
