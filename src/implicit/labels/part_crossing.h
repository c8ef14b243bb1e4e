// Walls whose vertices were moved, until no triangles intersect.
#pragma once

#include <vector>

#include "implicit/labels/label_walls.h"
#include "isoshell/backend.h"

namespace isoshell {

/// Lets vertices go back, as far as that takes, to where no triangles intersect: half of the way, and at last all of
/// it. After the first look only what moved can intersect anything. Cost: a search for intersections (see
/// crossing_pairs), and others near what goes back. Throws: interrupted.
void part_crossing(const LabelWalls& walls, const Buckets<uint32_t>& faces_at, const std::vector<PointQ8>& parted,
                   std::vector<PointQ8>& position, const Context& context);

}  // namespace isoshell
