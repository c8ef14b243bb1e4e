// Where the seeds of a path belong.
#pragma once

#include "features/seeds/facing_curves.h"

namespace isoshell {

/// How many edges of the lengths aimed at lie between the first vertex of a path and every other; of a loop there is
/// one more number, all around it.
std::vector<double> segments_along(const FineMesh& mesh, const CurvePath& path);

/// Gives every path its seeds: about one edge length apart, and rather at vertices where it bends, so that the chords
/// between them stay on it. Of all choices that with the least sum, over the segments, of (length / edge length - 1)^2
/// + 10 (distance of the path from the chord / edge length)^2; on jagged paths equal segments, where no seed may stay.
/// Where two paths run side by side, seeds of one are between those of the other, as far as that costs less than it
/// gains: .08 for a seed that faces another. Where points of `before` lie on a path its seeds are these, as far as
/// edges between them are not much too long or too short: a seed that stays saves .5. Cost: linear in the length of
/// paths over that of edges.
void place_path_seeds(FineMesh& mesh, const std::vector<FacingVertices>& facing,
                      const std::vector<WorldPoint>& before = {});

/// Every loop from its first seed, once seeds are vertices.
void begin_loops_at_seeds(FineMesh& mesh);

}  // namespace isoshell
