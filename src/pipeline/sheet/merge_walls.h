// The last resort against intersections: walls that are nearer to one another than edges can follow become one.
#pragma once

#include <vector>

#include "pipeline/grid/prepared_surface.h"

namespace isoshell {

constexpr int kMostMerges = 4;  ///< times that walls are grown, twice as far and around what then still intersects

struct MergedWalls {
  PreparedSurface prepared;  ///< in host memory, without what only the shell takes
  int32_t grown_vox = 0;
};
/// The prepared surface with the walls around these points of a result grown into one another: first by a voxel, or a
/// quarter of what gives a wall without thickness room for the edges of the result, and twice as far each time.
MergedWalls merge_walls(const PreparedSurface& prepared, const std::vector<PointQ8>& points, int times_before,
                        Context& context);

/// Says what was merged, and what the sheet is now.
void report_merge(const MergedWalls& merged, const std::vector<PointQ8>& points, RemeshReport& report);

}  // namespace isoshell
