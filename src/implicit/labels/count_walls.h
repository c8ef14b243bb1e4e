// How many walls a volume of labels has, before any is made.
#pragma once

#include <cstdint>

#include "isoshell/backend.h"
#include "isoshell/regions.h"

namespace isoshell {

struct WallCount {
  int64_t faces = 0;         ///< between voxels of different labels, those at the sides of the array too
  int64_t corners = 0;       ///< of voxels, where there are walls
  int64_t parted_edges = 0;  ///< of voxels, see WallEdge
  int64_t runs = 0;          ///< of voxels of one label along x

  int64_t triangles() const { return 2 * faces + 4 * parted_edges; }
  /// Corners with several sheets of walls are there between parted edges alone, and count once.
  int64_t vertices() const { return corners + 2 * parted_edges; }
};

/// Cost: a look at every voxel, in parallel. Throws: interrupted.
WallCount count_walls(const LabelVolume& volume, const Context& context);

}  // namespace isoshell
