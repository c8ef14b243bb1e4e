// The paths of a fine mesh where the result is wrong: with more seeds, or without the creases there.
#pragma once

#include <optional>
#include <vector>

#include "features/cutting/cut_surface.h"
#include "features/cutting/drop_paths.h"

namespace isoshell {

/// With another seed in the middle of every segment that is within about `reach_q8` of points. None where no path is
/// near a point, or segments there are too short to be cut.
std::optional<Paths> halve_segments(const FineMesh& mesh, const std::vector<PointQ8>& points, double reach_q8);

/// Without the segments, within an edge length of points, of the crease there that turns least (see without_edges).
/// None where no crease is so near.
std::optional<Paths> drop_creases(const FineMesh& mesh, const std::vector<PointQ8>& points);

/// Without the creases along borders that have less than three seeds all around; other curves there have more seeds.
/// None where there are no such borders, or their segments are too short to be cut.
std::optional<Paths> drop_creases_at_tight_borders(const CutSurface& cut);

/// Per path of `before` whether `after` does not have it, with as many seeds.
std::vector<char> which_changed(const Paths& before, const Paths& after);

}  // namespace isoshell
